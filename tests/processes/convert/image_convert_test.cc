#include "processes/convert/image_convert.h"

#include "estimation/base/random.h"
#include "processes/support/decode.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include <cmath>
#include <limits>
#include <string>
#include <vector>

namespace waymark {
namespace {

using testing::HasSubstr;

const ImageTags kTags{
    TimeFromMicroseconds(1'700'000'000'123'456), 41, HeadAngles{0.25, -0.5}};

// Soft shades with a colour of its own in each corner.
cv::Mat3b Scene(int width = 96, int height = 64) {
  cv::Mat3b image(height, width);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      image(y, x) = cv::Vec3b(static_cast<std::uint8_t>(255 * x / width),
                              static_cast<std::uint8_t>(255 * y / height),
                              static_cast<std::uint8_t>(200 - x));
    }
  }
  return image;
}

// The worst there is for JPEG.
cv::Mat3b Noise(int width, int height) {
  Random random(7);
  cv::Mat3b image(height, width);
  for (cv::Vec3b& pixel : image) {
    for (int c = 0; c < 3; ++c) {
      pixel[c] = static_cast<std::uint8_t>(255.0 * random.Uniform());
    }
  }
  return image;
}

image_t Encode(const cv::Mat& image,
               const ImageEncoderOptions& options = {},
               const ImageTags& tags = kTags) {
  std::string reason;
  const auto message = ImageEncoder(options).Encode(image, tags, &reason);
  EXPECT_TRUE(message) << reason;
  return message.value_or(image_t());
}

ImageEncoderOptions Raw() {
  ImageEncoderOptions options;
  options.format = ImageFormat::kRaw;
  return options;
}

std::string ErrorOf(const image_t& message) {
  std::string reason = "no error";
  const bool is_taken =
      ImageFromMessage(message, ImageColor::kAsSent, &reason).has_value();
  EXPECT_EQ(is_taken, reason == "no error") << reason;
  return reason;
}

double MeanDifference(const cv::Mat& a, const cv::Mat& b) {
  return cv::norm(a, b, cv::NORM_L1) /
         static_cast<double>(a.total() * a.elemSize());
}

TEST(ImageConvert, RawSurvivesTheRoundTripToTheBit) {
  const cv::Mat3b scene = Scene();
  // A part of a larger image: its rows are not side by side.
  const cv::Mat part = scene(cv::Rect(3, 5, 50, 31));
  cv::Mat gray;
  cv::cvtColor(part, gray, cv::COLOR_BGR2GRAY);
  std::string reason;
  for (const cv::Mat& image : {part, gray}) {
    const image_t message = Encode(image, Raw());
    EXPECT_EQ(message.row_stride, 50 * image.channels());
    const auto back = ImageFromMessage(message, ImageColor::kAsSent, &reason);
    ASSERT_TRUE(back) << reason;
    EXPECT_EQ(back->type(), image.type());
    EXPECT_EQ(cv::norm(*back, image, cv::NORM_INF), 0.0);
  }
}

TEST(ImageConvert, EveryFormatGivesTheColourThatIsAskedFor) {
  const cv::Mat3b scene = Scene();
  cv::Mat gray;
  cv::cvtColor(scene, gray, cv::COLOR_BGR2GRAY);
  image_t rgb = Encode(scene, Raw());
  cv::Mat swapped;
  cv::cvtColor(scene, swapped, cv::COLOR_BGR2RGB);
  rgb.pixelformat = image_t::PIXEL_FORMAT_RGB;
  rgb.data.assign(swapped.datastart, swapped.dataend);
  std::string reason;
  // Raw formats are exact; JPEG at its best is within two grey levels.
  for (const image_t& message : {Encode(scene, Raw()), rgb, Encode(scene)}) {
    const auto color = ImageFromMessage(message, ImageColor::kBgr, &reason);
    const auto as_gray = ImageFromMessage(message, ImageColor::kGray, &reason);
    ASSERT_TRUE(color && as_gray) << reason;
    ASSERT_EQ(color->type(), CV_8UC3);
    ASSERT_EQ(as_gray->type(), CV_8UC1);
    EXPECT_LT(MeanDifference(*color, scene), 2.0) << message.pixelformat;
    EXPECT_LT(MeanDifference(*as_gray, gray), 2.0) << message.pixelformat;
  }
  const auto color =
      ImageFromMessage(Encode(gray, Raw()), ImageColor::kBgr, &reason);
  ASSERT_TRUE(color);
  EXPECT_EQ((color->at<cv::Vec3b>(9, 9)[1]), gray.at<std::uint8_t>(9, 9));
}

TEST(ImageConvert, GrayByChoiceIsOneChannel) {
  for (const ImageFormat format : {ImageFormat::kJpeg, ImageFormat::kRaw}) {
    ImageEncoderOptions options;
    options.format = format;
    options.is_gray = true;
    std::string reason;
    const auto back = ImageFromMessage(
        Encode(Scene(), options), ImageColor::kAsSent, &reason);
    ASSERT_TRUE(back) << reason;
    EXPECT_EQ(back->channels(), 1);
  }
}

TEST(ImageConvert, TagsSurviveTheRoundTrip) {
  std::string reason;
  const image_t message = Encode(Scene());
  EXPECT_EQ(TagsFromMessage(message, &reason), kTags);
  EXPECT_EQ(SequenceOf(message), 41);
  const ImageTags bare{TimeFromMicroseconds(5), std::nullopt, std::nullopt};
  EXPECT_EQ(TagsFromMessage(Encode(Scene(), {}, bare), &reason), bare);
  // Keys of others say nothing to us.
  image_t other = message;
  other.metadata[0].key = "exposure";
  other.metadata[0].value.resize(3);
  ASSERT_TRUE(TagsFromMessage(other, &reason));
  EXPECT_FALSE(TagsFromMessage(other, &reason)->seq);
}

TEST(ImageConvert, ImpossibleTagsAreRefused) {
  const auto error_of = [](const image_t& message) {
    std::string reason = "no error";
    EXPECT_FALSE(TagsFromMessage(message, &reason));
    return reason;
  };
  const image_t good = Encode(Scene());
  image_t bad = good;
  bad.utime = 0;
  EXPECT_THAT(error_of(bad), HasSubstr("utime: 0 must be positive"));
  bad = good;
  bad.metadata[0].value.pop_back();
  EXPECT_THAT(error_of(bad), HasSubstr("metadata seq: 7 bytes must be 8"));
  bad = good;
  bad.metadata[2].key = "else";
  EXPECT_THAT(error_of(bad), HasSubstr("pan and tilt"));
  bad = Encode(Scene(),
               {},
               {kTags.time,
                1,
                HeadAngles{std::numeric_limits<double>::quiet_NaN(), 0.0}});
  EXPECT_THAT(error_of(bad), HasSubstr("must be finite"));
}

TEST(ImageConvert, QualityFollowsTheImages) {
  ImageEncoderOptions options;
  options.max_bytes = 10000;
  ImageEncoder encoder(options);
  std::string reason;
  const cv::Mat3b rough = Noise(160, 120);
  const auto first = encoder.Encode(rough, kTags, &reason);
  ASSERT_TRUE(first) << reason;
  EXPECT_LE(first->data.size(), 10000u);
  const int low = encoder.quality();
  EXPECT_LT(low, options.max_quality);
  // Easy images: up again, one step an image, and no further than allowed.
  for (int i = 0; i < 100; ++i) {
    const int before = encoder.quality();
    ASSERT_TRUE(encoder.Encode(Scene(), kTags, &reason));
    EXPECT_EQ(encoder.quality(), std::min(before + 1, options.max_quality));
  }
  // And down at once.
  const auto last = encoder.Encode(rough, kTags, &reason);
  ASSERT_TRUE(last);
  EXPECT_EQ(last->data, first->data);
}

TEST(ImageConvert, ImagesThatCannotBeSmallEnoughAreRefused) {
  ImageEncoderOptions options;
  options.max_bytes = 2000;
  std::string reason;
  EXPECT_FALSE(ImageEncoder(options).Encode(Noise(320, 240), kTags, &reason));
  EXPECT_THAT(reason, HasSubstr("JPEG of 320 x 240 px has"));
  EXPECT_THAT(reason, HasSubstr("at quality 20, more than 2000"));
}

TEST(ImageConvert, OptionsOutOfRangeAreNamed) {
  ImageEncoderOptions options;
  options.min_quality = 95;
  EXPECT_THROW(ImageEncoder{options}, std::invalid_argument);
  options = {};
  options.max_bytes = 10;
  EXPECT_THROW(ImageEncoder{options}, std::invalid_argument);
}

TEST(ImageConvert, WrongSizesAreRefused) {
  const image_t raw = Encode(Scene(), Raw());
  image_t bad = raw;
  bad.width = 0;
  EXPECT_THAT(ErrorOf(bad), HasSubstr("0 x 64 px must be in [1, 20000]"));
  bad = raw;
  bad.height = -64;
  EXPECT_THAT(ErrorOf(bad), HasSubstr("must be in"));
  bad = raw;
  bad.width = std::numeric_limits<std::int32_t>::max();
  EXPECT_THAT(ErrorOf(bad), HasSubstr("must be in"));
  bad = raw;
  bad.width = bad.height = 20000;
  EXPECT_THAT(ErrorOf(bad), HasSubstr("px must make at most 67108864"));
  bad = raw;
  bad.row_stride -= 1;
  EXPECT_THAT(ErrorOf(bad), HasSubstr("are not 96 x 64 px of 3 bytes"));
  bad = raw;
  bad.row_stride = std::numeric_limits<std::int32_t>::max();
  EXPECT_THAT(ErrorOf(bad), HasSubstr("are not"));
  bad = raw;
  bad.row_stride = -288;
  EXPECT_THAT(ErrorOf(bad), HasSubstr("are not"));
  bad = raw;
  bad.data.pop_back();
  EXPECT_THAT(ErrorOf(bad), HasSubstr("18431 bytes in rows of 288"));
  bad = raw;
  bad.pixelformat = 7;
  EXPECT_THAT(ErrorOf(bad), HasSubstr("pixelformat: 7 must be"));
  EXPECT_EQ(ErrorOf(raw), "no error");
}

TEST(ImageConvert, JpegThatIsNotWholeIsRefused) {
  const image_t good = Encode(Scene());
  image_t bad = good;
  for (const std::size_t size : {0u, 1u, 3u, 20u, 300u}) {
    bad.data.assign(good.data.begin(),
                    good.data.begin() + static_cast<std::ptrdiff_t>(size));
    EXPECT_NE(ErrorOf(bad), "no error") << size;
  }
  bad = good;
  bad.data.pop_back();
  EXPECT_THAT(ErrorOf(bad), HasSubstr("JPEG cut short at"));
  // Zeros after the end are padding.
  bad = good;
  bad.data.resize(good.data.size() + 100);
  EXPECT_EQ(ErrorOf(bad), "no error");
  bad = good;
  bad.data[0] = 0;
  EXPECT_THAT(ErrorOf(bad), HasSubstr("are no JPEG"));
}

TEST(ImageConvert, JpegOfAnotherSizeIsRefusedBeforeItIsDecoded) {
  const image_t good = Encode(Scene());
  image_t bad = good;
  bad.width = 95;
  EXPECT_THAT(ErrorOf(bad), HasSubstr("95 x 64 px, but its JPEG has 96 x 64"));
  // Some hundred bytes that claim four gigapixels.
  bad = good;
  for (std::size_t i = 2; i + 9 < bad.data.size(); ++i) {
    if (bad.data[i] != 0xff || bad.data[i + 1] != 0xc0) continue;
    for (std::size_t k = 5; k < 9; ++k) bad.data[i + k] = 0xff;
    break;
  }
  EXPECT_THAT(ErrorOf(bad), HasSubstr("but its JPEG has 65535 x 65535"));
}

TEST(ImageConvert, BytesOfNoiseNeverHarm) {
  const image_t good = Encode(Scene());
  Random random(11);
  for (int i = 0; i < 300; ++i) {
    image_t bad = good;
    // Only the headers: behind them libjpeg says on stderr what it mends.
    for (int k = 0; k < 4; ++k) {
      const auto at = static_cast<std::size_t>(600.0 * random.Uniform());
      bad.data[at] = static_cast<std::uint8_t>(256.0 * random.Uniform());
    }
    std::string reason;
    const auto image = ImageFromMessage(bad, ImageColor::kBgr, &reason);
    if (image) {
      EXPECT_EQ(image->size(), cv::Size(96, 64));
    } else {
      EXPECT_FALSE(reason.empty());
    }
  }
}

}  // namespace
}  // namespace waymark
