#include "processes/video/video_process.h"

#include "estimation/base/input_error.h"
#include "estimation/base/random.h"
#include "processes/convert/camera_convert.h"
#include "processes/support/channels.h"
#include "processes/support/configuration.h"
#include "processes/support/decode.h"
#include "processes/support/local_bus.h"
#include "tests/support/temporary_directory.h"
#include "tests/support/test_video.h"

#include <waymark/camera_info_t.hpp>
#include <waymark/image_t.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace waymark {
namespace {

using testing::HasSubstr;

const Time kStart = TimeFromMicroseconds(1'700'000'000'000'000);
constexpr const char* kChannel = "IMAGE_FRONT";
constexpr const char* kInfoChannel = "CAMERA_INFO_FRONT";

struct World {
  explicit World(const VideoConfig& config)
      : process(config, local.AddProcess("video")) {}
  void Run(double seconds) {
    local.RunUntil(local.now() + DurationFromSeconds(seconds));
  }
  [[nodiscard]] std::vector<image_t> Images() const {
    return local.Messages<image_t>(kChannel);
  }
  LocalBus local{kStart};
  VideoProcess process;
};

struct Folder {
  Folder() {
    for (int i = 0; i < 5; ++i) {
      WriteImage(directory / ("image" + std::to_string(i) + ".png"),
                 NumberedImage(i));
    }
    config.source.source = directory / "";
    config.source.rate_hz = 16.0;
  }
  void Calibrate(int width, int height) {
    const std::string text =
        "model: perspective\nwidth: " + std::to_string(width) +
        "\nheight: " + std::to_string(height) +
        "\nfx: 50\nfy: 50\ncx: 32\ncy: 24\n";
    config.calibration = directory / "camera.yaml";
    WriteBytes(
        config.calibration,
        {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
  }
  TemporaryDirectory directory;
  VideoConfig config;
};

TEST(VideoProcess, PublishesImagesWhenTheyAreDue) {
  const Folder folder;
  World world(folder.config);
  world.Run(1.0);
  const std::vector<image_t> images = world.Images();
  ASSERT_EQ(images.size(), 5u);
  for (std::size_t i = 0; i < images.size(); ++i) {
    std::string reason;
    const auto pixels =
        ImageFromMessage(images[i], ImageColor::kAsSent, &reason);
    ASSERT_TRUE(pixels) << reason;
    EXPECT_EQ(NumberOf(*pixels), static_cast<int>(i));
    EXPECT_EQ(SequenceOf(images[i]), static_cast<std::int64_t>(i));
    // The first with the first look for images; then exactly 16 Hz.
    EXPECT_EQ(images[i].utime - images[0].utime,
              static_cast<std::int64_t>(i) * 62'500);
    EXPECT_EQ(images[i].pixelformat, image_t::PIXEL_FORMAT_MJPEG);
  }
  EXPECT_TRUE(world.local.Messages<camera_info_t>(kInfoChannel).empty());
  EXPECT_EQ(world.local.Status("video").fault, "");
}

TEST(VideoProcess, PlaysVideoFilesInALoopAsRawGray) {
  const TemporaryDirectory directory;
  WriteNumberedVideo(directory / "a.avi", 4, 20.0);
  VideoConfig config;
  config.source.source = directory / "a.avi";
  config.source.loops = true;
  config.encoder.format = ImageFormat::kRaw;
  config.encoder.is_gray = true;
  World world(config);
  world.Run(1.0);
  const std::vector<image_t> images = world.Images();
  ASSERT_GE(images.size(), 19u);
  EXPECT_EQ(images[0].pixelformat, image_t::PIXEL_FORMAT_GRAY);
  EXPECT_EQ(images[0].data.size(), 64u * 48u);
  std::string reason;
  EXPECT_EQ(
      NumberOf(*ImageFromMessage(images[6], ImageColor::kAsSent, &reason)), 2);
}

TEST(VideoProcess, SaysOnceASecondWhatTheCameraIs) {
  Folder folder;
  folder.Calibrate(64, 48);
  World world(folder.config);
  world.Run(3.5);
  const auto infos = world.local.Messages<camera_info_t>(kInfoChannel);
  // With the first image, then at 1, 2 and 3 s.
  ASSERT_EQ(infos.size(), 4u);
  EXPECT_EQ(infos[3].seq, 3);
  EXPECT_EQ(infos[0].camera, "FRONT");
  std::string reason;
  const auto camera = CameraFromMessage(infos[0], &reason);
  ASSERT_TRUE(camera) << reason;
  EXPECT_EQ(camera->size, (ImageSize{64, 48}));
}

TEST(VideoProcess, CalibrationOfAnotherSizeIsAFaultAndWithheld) {
  Folder folder;
  folder.Calibrate(640, 480);
  World world(folder.config);
  world.Run(2.5);
  EXPECT_THAT(world.local.Status("video").fault,
              HasSubstr("camera.yaml: is for 640 x 480 px, the images have "
                        "64 x 48 px"));
  EXPECT_TRUE(world.local.Messages<camera_info_t>(kInfoChannel).empty());
  EXPECT_EQ(world.Images().size(), 5u);
}

TEST(VideoProcess, ImagesThatCannotBeSentAreAFaultNotAGapInSeq) {
  Folder folder;
  cv::Mat noise(480, 640, CV_8UC3);
  Random random(1);
  for (int i = 0; i < noise.rows * noise.cols * 3; ++i) {
    noise.data[i] = static_cast<std::uint8_t>(random.Bits());
  }
  WriteImage(folder.directory / "image2.png", noise);
  folder.config.encoder.max_bytes = 20000;
  folder.config.source.rate_hz = 1.0;
  World world(folder.config);
  world.Run(2.5);
  EXPECT_THAT(world.local.Status("video").fault,
              HasSubstr("JPEG of 640 x 480 px has"));
  world.Run(2.0);
  EXPECT_EQ(world.local.Status("video").fault, "");
  ASSERT_EQ(world.Images().size(), 4u);
  EXPECT_EQ(SequenceOf(world.Images()[3]), 3);
}

TEST(VideoProcess, MissingCameraIsAFault) {
  VideoConfig config;
  config.source.source = "/dev/video987";
  World world(config);
  for (int i = 0; i < 1000 && world.local.Status("video").fault.empty(); ++i) {
    world.Run(0.01);
  }
  EXPECT_TRUE(world.Images().empty());
  EXPECT_NE(world.local.Status("video").fault, "");
}

TEST(VideoProcess, BadConfigurationIsOneLine) {
  const auto error_of = [](const std::vector<std::string>& settings) {
    VideoConfig config;
    try {
      LoadConfiguration("", settings, &config);
      World world(config);
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string("no error");
  };
  EXPECT_THAT(error_of({"camera=front"}),
              HasSubstr("camera = front must consist of A-Z, 0-9 and _"));
  EXPECT_THAT(error_of({"source=''"}), HasSubstr("source is missing"));
  EXPECT_THAT(error_of({"jpeg_min_quality=95"}), HasSubstr("quality"));
  EXPECT_THAT(error_of({"source=/no/such.avi"}),
              HasSubstr("/no/such.avi: no such folder, pattern or video file"));
  EXPECT_THAT(error_of({"calibration=/no/such.yaml"}),
              HasSubstr("/no/such.yaml"));
}

}  // namespace
}  // namespace waymark
