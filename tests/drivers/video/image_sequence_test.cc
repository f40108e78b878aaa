#include "drivers/video/image_sequence.h"

#include "estimation/base/input_error.h"
#include "tests/support/temporary_directory.h"
#include "tests/support/test_video.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

namespace waymark {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

void WriteText(const std::string& path, const std::string& text) {
  WriteBytes(path,
             {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
}

struct Folder {
  // Image i under the i-th name.
  explicit Folder(const std::vector<std::string>& names) {
    for (std::size_t i = 0; i < names.size(); ++i) {
      WriteImage(directory / names[i], NumberedImage(static_cast<int>(i)));
    }
  }
  [[nodiscard]] ImageSequence Open(const std::string& times_text = "",
                                   double rate_hz = 0.0) const {
    if (times_text.empty()) return {directory / "", "", rate_hz};
    WriteText(directory / "times.txt", times_text);
    return {directory / "", directory / "times.txt", rate_hz};
  }
  [[nodiscard]] std::string ErrorOf(const std::string& times_text) const {
    try {
      (void)Open(times_text);
    } catch (const InputError& error) {
      return error.what();
    }
    return "no error";
  }
  TemporaryDirectory directory;
};

// Number and milliseconds of each image.
std::vector<std::pair<int, std::int64_t>> All(ImageSequence sequence) {
  std::vector<std::pair<int, std::int64_t>> all;
  while (const auto time = sequence.NextTime()) {
    std::string error;
    const auto image = sequence.Read(&error);
    all.emplace_back(image ? NumberOf(*image) : -1, time->count() / 1000);
  }
  return all;
}

using Pair = std::pair<int, std::int64_t>;

TEST(ImageSequence, NamesThatAreNanosecondsAreTimes) {
  const Folder folder({"100000000.png", "24062500000.jpg", "24000000000.jpg"});
  EXPECT_THAT(All(folder.Open()),
              ElementsAre(Pair{0, 0}, Pair{2, 23900}, Pair{1, 23962}));
}

TEST(ImageSequence, NumbersOfFramesAreNoTimesAndSortByValue) {
  const Folder folder({"frame10.png", "frame9.png", "frame011.png", "a.png"});
  EXPECT_THAT(
      All(folder.Open()),
      ElementsAre(Pair{3, 0}, Pair{1, 100}, Pair{0, 200}, Pair{2, 300}));
  const Folder numbers({"10.png", "2.png", "3.png"});
  EXPECT_THAT(All(numbers.Open("", 4.0)),
              ElementsAre(Pair{1, 0}, Pair{2, 250}, Pair{0, 500}));
}

TEST(ImageSequence, TimesFileGivesTimesInOrderOrByName) {
  const Folder folder({"a.png", "b.png", "c.png"});
  EXPECT_THAT(All(folder.Open("1.5\n1.75 # late\n\n2.0\n")),
              ElementsAre(Pair{0, 0}, Pair{1, 250}, Pair{2, 500}));
  // Names choose, also from a folder that the file has elsewhere.
  EXPECT_THAT(All(folder.Open("# time, name\n1700000000.100,c.png\n"
                              "1700000000.400,rgb/a.png\n")),
              ElementsAre(Pair{2, 0}, Pair{0, 300}));
}

TEST(ImageSequence, BadTimesAreOneLineWithFileAndLine) {
  const Folder folder({"a.png", "b.png"});
  EXPECT_THAT(folder.ErrorOf("1\n2\n3\n"), HasSubstr("3 times for 2 images"));
  EXPECT_THAT(folder.ErrorOf("1\nx\n"),
              HasSubstr("times.txt:2: time 'x' must be a number of seconds"));
  EXPECT_THAT(folder.ErrorOf("1\nnan\n"), HasSubstr("must be a number"));
  EXPECT_THAT(folder.ErrorOf("1\n1e300\n"), HasSubstr("must be a number"));
  EXPECT_THAT(folder.ErrorOf("2\n2\n"), HasSubstr("above the one before"));
  EXPECT_THAT(folder.ErrorOf("1 a.png\n2\n"), HasSubstr(":2: time '2' has"));
  EXPECT_THAT(folder.ErrorOf("1 a.png\n2 z.png\n"),
              HasSubstr("no such image: z.png"));
  EXPECT_THAT(folder.ErrorOf("#\n"), HasSubstr("no times in it"));
}

TEST(ImageSequence, PatternsChooseAndNothingFoundIsAnError) {
  const Folder folder({"left_1.png", "left_2.png", "right_1.png"});
  EXPECT_EQ(
      ImageSequence(folder.directory / "left_*.png", "", 0).entries().size(),
      2u);
  EXPECT_THROW(ImageSequence(folder.directory / "up_*.png", "", 0), InputError);
  std::filesystem::create_directory(folder.directory / "empty");
  EXPECT_THROW(ImageSequence(folder.directory / "empty", "", 0), InputError);
}

TEST(ImageSequence, ImagesThatAreNoneAreOneLineEach) {
  const Folder folder({"1.jpg", "2.jpg", "3.jpg", "4.png", "5.png", "6.jpg"});
  const auto truncate = [&](const std::string& name, std::size_t size) {
    std::vector<std::uint8_t> bytes = ReadBytes(folder.directory / name);
    bytes.resize(size);
    WriteBytes(folder.directory / name, bytes);
  };
  truncate("2.jpg", 400);
  truncate("3.jpg", 0);
  truncate("4.png", 60);
  WriteText(folder.directory / "5.png", "no image");
  ImageSequence sequence = folder.Open();
  std::vector<std::string> errors;
  std::vector<int> numbers;
  while (sequence.NextTime()) {
    std::string error;
    if (const auto image = sequence.Read(&error)) {
      numbers.push_back(NumberOf(*image));
    } else {
      errors.push_back(error);
    }
  }
  EXPECT_THAT(numbers, ElementsAre(0, 5));
  ASSERT_EQ(errors.size(), 4u);
  EXPECT_THAT(errors[0], HasSubstr("2.jpg: JPEG cut short at"));
  EXPECT_THAT(errors[1], HasSubstr("3.jpg: is no PNG"));
  EXPECT_THAT(errors[2], HasSubstr("4.png: the image is broken"));
  EXPECT_THAT(errors[3], HasSubstr("5.png: is no PNG"));
}

}  // namespace
}  // namespace waymark
