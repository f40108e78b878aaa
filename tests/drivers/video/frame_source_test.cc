#include "drivers/video/frame_source.h"

#include "estimation/base/input_error.h"
#include "tests/support/temporary_directory.h"
#include "tests/support/test_video.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <string>
#include <thread>
#include <vector>

namespace waymark {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

const Time kStart = TimeFromMicroseconds(1'700'000'000'000'000);

std::unique_ptr<FrameSource> Open(const FrameSourceOptions& options) {
  return OpenFrameSource(options, [] { return kStart; });
}

void WriteNumbered(const TemporaryDirectory& directory, int num) {
  for (int i = 0; i < num; ++i) {
    WriteImage(directory / ("image" + std::to_string(i) + ".png"),
               NumberedImage(i));
  }
}

// Number and ms since the start of all frames taken every `period_ms`.
std::vector<std::pair<int, std::int64_t>> Play(FrameSource* source,
                                               int until_ms,
                                               int period_ms = 5) {
  std::vector<std::pair<int, std::int64_t>> taken;
  for (int ms = 0; ms <= until_ms; ms += period_ms) {
    if (const auto frame = source->Take(kStart + Duration(ms * 1000))) {
      taken.emplace_back(NumberOf(frame->image),
                         (frame->time - kStart).count() / 1000);
    }
  }
  return taken;
}

using Pair = std::pair<int, std::int64_t>;

TEST(FrameSource, ImagesComeWhenTheyAreDueAndEnd) {
  const TemporaryDirectory directory;
  WriteNumbered(directory, 3);
  const auto source = Open({.source = directory / "", .rate_hz = 16.0});
  EXPECT_THAT(Play(source.get(), 300),
              ElementsAre(Pair{0, 0}, Pair{1, 62}, Pair{2, 125}));
  EXPECT_TRUE(source->has_ended());
  EXPECT_EQ(source->Fault(), "");
  EXPECT_EQ(source->num_missed(), 0);
}

TEST(FrameSource, LoopsWithTheLastGap) {
  const TemporaryDirectory directory;
  WriteNumbered(directory, 3);
  const auto source =
      Open({.source = directory / "", .rate_hz = 20.0, .loops = true});
  EXPECT_THAT(Play(source.get(), 260),
              ElementsAre(Pair{0, 0},
                          Pair{1, 50},
                          Pair{2, 100},
                          Pair{0, 150},
                          Pair{1, 200},
                          Pair{2, 250}));
  EXPECT_FALSE(source->has_ended());
}

TEST(FrameSource, LateTakersGetTheNewestAndTheRestIsCounted) {
  const TemporaryDirectory directory;
  WriteNumbered(directory, 10);
  const auto source = Open({.source = directory / "", .rate_hz = 20.0});
  EXPECT_THAT(Play(source.get(), 300, 120),
              ElementsAre(Pair{0, 0}, Pair{2, 100}, Pair{4, 200}));
  EXPECT_EQ(source->num_missed(), 2);
}

TEST(FrameSource, VideoFilesPlayAtTheirRate) {
  const TemporaryDirectory directory;
  WriteNumberedVideo(directory / "a.avi", 4, 25.0);
  const auto source = Open({.source = directory / "a.avi", .loops = true});
  EXPECT_THAT(Play(source.get(), 200),
              ElementsAre(Pair{0, 0},
                          Pair{1, 40},
                          Pair{2, 80},
                          Pair{3, 120},
                          Pair{0, 160},
                          Pair{1, 200}));
}

TEST(FrameSource, CorruptImagesAreSkippedWithALineEach) {
  const TemporaryDirectory directory;
  WriteNumbered(directory, 3);
  WriteBytes(directory / "image1.png", {});
  const auto source = Open({.source = directory / "", .rate_hz = 20.0});
  EXPECT_THAT(Play(source.get(), 200), ElementsAre(Pair{0, 0}, Pair{2, 100}));
  EXPECT_THAT(source->TakeWarnings(),
              ElementsAre(HasSubstr("image1.png: is no PNG")));
  EXPECT_TRUE(source->TakeWarnings().empty());
  EXPECT_EQ(source->Fault(), "");
}

TEST(FrameSource, WithoutAnyReadableImageItEndsWithAFault) {
  const TemporaryDirectory directory;
  WriteBytes(directory / "a.png", {});
  WriteBytes(directory / "b.png", {});
  const auto source = Open({.source = directory / "", .loops = true});
  EXPECT_TRUE(Play(source.get(), 1000).empty());
  EXPECT_TRUE(source->has_ended());
  EXPECT_THAT(source->Fault(), HasSubstr("no image of it can be read"));
}

TEST(FrameSource, FilesThatAreNotThereAreRefused) {
  EXPECT_THROW((void)Open({.source = "/no/such/file.mp4"}), InputError);
  EXPECT_THROW((void)Open({.source = "/no/such/*.png"}), InputError);
  EXPECT_THROW((void)Open({}), std::invalid_argument);
  EXPECT_THROW((void)Open({.source = "/dev/video0", .width = 640}),
               std::invalid_argument);
}

TEST(FrameSource, CameraThatIsNotThereIsOneLine) {
  const auto source = Open({.source = "/dev/video987"});
  for (int i = 0; i < 5000 && source->Fault().empty(); ++i) {
    EXPECT_FALSE(source->Take(kStart));
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  EXPECT_EQ(source->Fault(),
            "/dev/video987: cannot open: No such file or directory");
  // A device that is no camera.
  const auto null = Open({.source = "/dev/null"});
  for (int i = 0; i < 5000 && null->Fault().empty(); ++i) {
    EXPECT_FALSE(null->Take(kStart));
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  EXPECT_EQ(null->Fault(),
            "/dev/null: is no camera, or another process uses it");
}

}  // namespace
}  // namespace waymark
