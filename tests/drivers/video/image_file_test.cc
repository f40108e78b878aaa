#include "drivers/video/image_file.h"

#include "drivers/video/image_size.h"
#include "estimation/base/input_error.h"
#include "tests/support/temporary_directory.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>

#include <cstdint>
#include <fstream>
#include <string>
#include <vector>

namespace waymark {
namespace {

using testing::HasSubstr;
using Bytes = std::vector<std::uint8_t>;

// A ramp, so that a turned image is another one.
cv::Mat Ramp(int type) {
  cv::Mat image(5, 9, type);
  for (int y = 0; y < image.rows; ++y) {
    for (int x = 0; x < image.cols * image.channels(); ++x) {
      image.ptr<std::uint8_t>(y)[x] = static_cast<std::uint8_t>(40 * y + x);
    }
  }
  return image;
}

Bytes Encoded(const std::string& extension, const cv::Mat& image) {
  Bytes bytes;
  cv::imencode(extension, image, bytes);
  return bytes;
}

std::string ErrorOf(const Bytes& bytes) {
  try {
    (void)DecodeImage(bytes, "a.png", ImageFileColor::kGray);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

class ImageFileFormat : public testing::TestWithParam<std::string> {};

TEST_P(ImageFileFormat, SizeStandsInTheHeader) {
  for (const int type : {CV_8UC1, CV_8UC3}) {
    // Each of the two has one number of channels.
    if (GetParam() == ".pgm" && type == CV_8UC3) continue;
    if (GetParam() == ".ppm" && type == CV_8UC1) continue;
    Bytes bytes = Encoded(GetParam(), Ramp(type));
    std::string reason;
    const auto size = SizeOfImageFile(bytes, &reason);
    ASSERT_TRUE(size) << reason;
    EXPECT_EQ(size->width, 9);
    EXPECT_EQ(size->height, 5);
    const cv::Mat image = DecodeImage(bytes, "a", ImageFileColor::kGrayOrBgr);
    EXPECT_EQ(image.size(), cv::Size(9, 5));
    EXPECT_EQ(image.type(), type);
    // Cut anywhere: an answer or a reason.
    for (std::size_t length = 0; length < bytes.size(); ++length) {
      reason.clear();
      EXPECT_TRUE(
          SizeOfImageFile({bytes.data(), length}, &reason).has_value() ||
          !reason.empty());
    }
  }
}

INSTANTIATE_TEST_SUITE_P(
    All,
    ImageFileFormat,
    testing::Values(".png", ".jpg", ".bmp", ".pgm", ".ppm", ".tif"),
    [](const auto& format) { return format.param.substr(1); });

// 60 bytes that ask for gigabytes.
TEST(ImageFile, ASmallFileCannotAskForMuchMemory) {
  Bytes png = Encoded(".png", Ramp(CV_8UC1));
  png[16] = 0x7f;
  EXPECT_THAT(ErrorOf(png), HasSubstr("a.png: 2130706441 x 5 pixels"));
  const std::string text = "P5 # a comment\n60000 60000 255\n";
  EXPECT_THAT(ErrorOf(Bytes(text.begin(), text.end())),
              HasSubstr("60000 x 60000 pixels; each side must be in"));
  Bytes bmp = Encoded(".bmp", Ramp(CV_8UC3));
  bmp[20] = 0x70;
  EXPECT_THAT(ErrorOf(bmp), HasSubstr("pixels; each side"));
  // Rows that go down: a negative height.
  Bytes down = Encoded(".bmp", Ramp(CV_8UC3));
  for (std::size_t i = 22; i < 26; ++i) down[i] = i == 22 ? 0xfb : 0xff;
  std::string reason;
  EXPECT_EQ(SizeOfImageFile(down, &reason)->height, 5);
  EXPECT_THAT(ErrorOf({'P', '5', ' '}), HasSubstr("its header is broken"));
  EXPECT_THAT(ErrorOf({'G', 'I', 'F'}), HasSubstr("is no PNG, JPEG"));
}

// One entry of a TIFF's directory, little-endian.
struct TiffEntry {
  std::uint32_t tag = 0;
  std::uint32_t type = 0;  // 3 is SHORT, 4 is LONG.
  std::uint32_t count = 1;
  std::uint32_t value = 0;
};

void Append(std::uint32_t value, int length, Bytes* bytes) {
  for (int i = 0; i < length; ++i) {
    bytes->push_back(static_cast<std::uint8_t>(value >> (8 * i)));
  }
}

// Nine gray pixels in a row, if these entries say so.
Bytes Tiff(const std::vector<TiffEntry>& sizes) {
  constexpr std::uint32_t kPixels = 8;
  std::vector<TiffEntry> entries = sizes;
  entries.insert(entries.end(),
                 {{258, 3, 1, 8},
                  {259, 3, 1, 1},
                  {262, 3, 1, 1},
                  {273, 4, 1, kPixels},
                  {277, 3, 1, 1},
                  {278, 3, 1, 1},
                  {279, 4, 1, 9}});
  Bytes bytes{'I', 'I', 42, 0, 18, 0, 0, 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 0};
  Append(static_cast<std::uint32_t>(entries.size()), 2, &bytes);
  for (const TiffEntry& entry : entries) {
    Append(entry.tag, 2, &bytes);
    Append(entry.type, 2, &bytes);
    Append(entry.count, 4, &bytes);
    Append(entry.value, 4, &bytes);
  }
  Append(0, 4, &bytes);
  return bytes;
}

// What a decoder takes for the size is what is checked, or the file is refused.
TEST(ImageFile, ATiffSaysItsSizeOnceAndPlainly) {
  constexpr std::uint32_t kShort = 3;
  constexpr std::uint32_t kLong = 4;
  std::string reason;
  // Behind a SHORT its field may hold anything.
  for (const TiffEntry width : {TiffEntry{256, kShort, 1, 9},
                                {256, kShort, 1, 0x77770009},
                                {256, kLong, 1, 9}}) {
    const Bytes good = Tiff({width, {257, kShort, 1, 1}});
    const auto size = SizeOfImageFile(good, &reason);
    ASSERT_TRUE(size) << reason;
    EXPECT_EQ(size->width, 9);
    EXPECT_EQ(size->height, 1);
    EXPECT_EQ(DecodeImage(good, "a", ImageFileColor::kGray).size(),
              cv::Size(9, 1));
  }
  constexpr std::uint32_t kByte = 1;
  constexpr std::uint32_t kSignedShort = 8;
  constexpr std::uint32_t kLong8 = 16;
  for (const std::vector<TiffEntry>& bad : std::vector<std::vector<TiffEntry>>{
           {{256, kLong, 1, 30000}, {256, kLong, 1, 9}, {257, kLong, 1, 1}},
           {{256, kLong, 1, 9}, {257, kLong, 1, 30000}, {257, kLong, 1, 1}},
           {{256, kLong, 1, 9}, {256, kLong, 1, 9}, {257, kLong, 1, 1}},
           {{256, kByte, 1, 9}, {257, kLong, 1, 1}},
           {{256, kSignedShort, 1, 9}, {257, kLong, 1, 1}},
           {{256, kLong8, 1, 9}, {257, kLong, 1, 1}},
           {{256, kLong, 2, 9}, {257, kLong, 1, 1}},
           {{256, kShort, 0, 9}, {257, kLong, 1, 1}},
           {{256, kLong, 1, 9}},
           {{257, kLong, 1, 1}}}) {
    EXPECT_EQ(ErrorOf(Tiff(bad)), "a.png: its header is broken");
  }
}

// "Held on its side" in the notes of a JPEG: pixels stay where they are.
TEST(ImageFile, PixelsStayWhereTheyAre) {
  const Bytes plain = Encoded(".jpg", Ramp(CV_8UC1));
  const Bytes note{0xff, 0xe1, 0, 34, 'E', 'x', 'i', 'f', 0, 0,  'M', 'M',
                   0,    42,   0, 0,  0,   8,   0,   1,   1, 18, 0,   3,
                   0,    0,    0, 1,  0,   6,   0,   0,   0, 0,  0,   0};
  Bytes turned = plain;
  turned.insert(turned.begin() + 2, note.begin(), note.end());
  ASSERT_EQ(cv::imdecode(turned, cv::IMREAD_COLOR).size(), cv::Size(5, 9))
      << "the note is not understood: this test tests nothing";
  for (const ImageFileColor color : {ImageFileColor::kGray,
                                     ImageFileColor::kBgr,
                                     ImageFileColor::kGrayOrBgr,
                                     ImageFileColor::kAsStored}) {
    EXPECT_EQ(DecodeImage(turned, "a.jpg", color).size(), cv::Size(9, 5));
  }
}

TEST(ImageFile, ReadsFiles) {
  const TemporaryDirectory folder;
  const std::string path = folder / "ramp.png";
  cv::imwrite(path, Ramp(CV_8UC3));
  EXPECT_EQ(LoadImageFile(path, ImageFileColor::kBgr).channels(), 3);
  EXPECT_EQ(LoadImageFile(path, ImageFileColor::kGray).channels(), 1);
  EXPECT_THROW((void)LoadImageFile(folder / "none.png", ImageFileColor::kGray),
               InputError);
  EXPECT_THROW((void)LoadImageFile(folder / "", ImageFileColor::kGray),
               InputError);
}

}  // namespace
}  // namespace waymark
