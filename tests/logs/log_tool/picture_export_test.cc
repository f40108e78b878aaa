#include "logs/log_tool/picture_export.h"

#include "processes/convert/image_convert.h"
#include "tests/logs/log_tool/log_maker.h"

#include <waymark/image_t.hpp>

#include <gmock/gmock.h>
#include <opencv2/imgcodecs.hpp>

#include <filesystem>

namespace waymark {
namespace {

using testing::HasSubstr;

class PictureExportTest : public LogToolTest {
 protected:
  static image_t Image(std::int64_t utime, ImageFormat format, int gray) {
    ImageEncoderOptions options;
    options.format = format;
    ImageTags tags;
    tags.time = TimeFromMicroseconds(utime);
    std::string reason;
    return *ImageEncoder(options).Encode(
        cv::Mat1b(6, 8, static_cast<std::uint8_t>(gray)), tags, &reason);
  }
  // JPEG at the front, raw at the back, and what is no image.
  void WriteImages() {
    LogWriter writer(log_);
    for (int i = 0; i < 3; ++i) {
      writer.Write("IMAGE_FRONT",
                   Image(kLogStart + i, ImageFormat::kJpeg, 50 + i));
      writer.Write("IMAGE/BACK", Image(kLogStart, ImageFormat::kRaw, 150 + i));
      writer.Write("IMAGE_OF_OTHERS", MakeEncoders(kLogStart, i));
    }
    image_t torn = Image(kLogStart + 9, ImageFormat::kJpeg, 0);
    torn.data.resize(torn.data.size() / 2);
    torn.size = static_cast<std::int32_t>(torn.data.size());
    writer.Write("IMAGE_FRONT", torn);
    writer.Close();
  }
  [[nodiscard]] std::string PathOf(const std::string& name) const {
    return folder_ + "/" + name;
  }
  int NumFiles() const {
    int num = 0;
    for (const auto& entry : std::filesystem::directory_iterator(folder_)) {
      (void)entry;
      ++num;
    }
    return num;
  }

  std::string folder_ = directory_ / "pictures";
};

TEST_F(PictureExportTest, WritesEveryImageUnderChannelAndTime) {
  WriteImages();
  const PictureReport report =
      ExportPictures(log_, folder_, {.max_files = 100});
  ASSERT_EQ(report.channels.size(), 2u);
  EXPECT_EQ(report.channels[0].name, "IMAGE/BACK");
  EXPECT_EQ(report.channels[0].num_files, 3);
  EXPECT_EQ(report.channels[1].num_files, 3);
  EXPECT_EQ(report.channels[1].num_bad, 1) << "the torn one";
  EXPECT_THAT(report.channels[1].reason, HasSubstr("data"));
  EXPECT_EQ(report.num_left_out, 0);
  EXPECT_EQ(NumFiles(), 6);
  // A JPEG is the bytes that were sent.
  const auto sent = Image(kLogStart + 1, ImageFormat::kJpeg, 51).data;
  const auto bytes = ReadBytes(PathOf("IMAGE_FRONT_1700000000000001.jpg"));
  EXPECT_TRUE(std::equal(sent.begin(), sent.end(), bytes.begin(), bytes.end()));
  // No channel leads out of the folder, and none of the same time is lost.
  for (const auto& [name, gray] :
       {std::pair("IMAGE_BACK_1700000000000000.png", 150),
        {"IMAGE_BACK_1700000000000000_3.png", 152}}) {
    const cv::Mat image = cv::imread(PathOf(name), cv::IMREAD_UNCHANGED);
    ASSERT_EQ(image.size(), cv::Size(8, 6)) << name;
    EXPECT_EQ(image.at<std::uint8_t>(3, 3), gray);
  }
}

TEST_F(PictureExportTest, WritesNoMoreThanAskedForAndOneChannel) {
  WriteImages();
  const PictureReport report =
      ExportPictures(log_, folder_, {.channel = "IMAGE_FRONT", .max_files = 2});
  ASSERT_EQ(report.channels.size(), 1u);
  EXPECT_EQ(report.channels[0].num_files, 2);
  EXPECT_EQ(report.num_left_out, 2);
  EXPECT_EQ(NumFiles(), 2);
}

TEST_F(PictureExportTest, RefusesInOneLine) {
  WriteImages();
  const auto error = [&](const std::string& channel) {
    return ErrorOf([&] {
      (void)ExportPictures(log_, folder_, {.channel = channel, .max_files = 9});
    });
  };
  EXPECT_EQ(error("POSE"), log_ + ": has no images on POSE");
  EXPECT_EQ(error("IMAGE_OF_OTHERS"),
            log_ + ": has no images on IMAGE_OF_OTHERS");
  EXPECT_FALSE(std::filesystem::exists(folder_));
  EXPECT_EQ(error(""), "no InputError");
  EXPECT_THAT(error(""), HasSubstr("exists")) << "nothing is replaced";
}

}  // namespace
}  // namespace waymark
