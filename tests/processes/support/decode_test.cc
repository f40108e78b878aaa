#include "processes/support/decode.h"

#include <waymark/encoders_t.hpp>
#include <waymark/image_t.hpp>
#include <waymark/position_fix_t.hpp>
#include <waymark/status_t.hpp>

#include <gtest/gtest.h>

#include <cstdint>
#include <vector>

namespace waymark {
namespace {

using Bytes = std::vector<std::uint8_t>;

template <typename M>
Bytes Encode(const M& message) {
  Bytes data(static_cast<std::size_t>(message.getEncodedSize()));
  message.encode(data.data(), 0, static_cast<int>(data.size()));
  return data;
}

void PutInt32(Bytes* data, std::size_t at, std::uint32_t value) {
  for (std::size_t i = 0; i < 4; ++i) {
    data->at(at + i) = static_cast<std::uint8_t>(value >> (24 - 8 * i));
  }
}

image_t SmallImage() {
  image_t image;
  image.utime = 5'000'000;
  image.width = 2;
  image.height = 1;
  image.row_stride = 2;
  image.pixelformat = image_t::PIXEL_FORMAT_GRAY;
  image.size = 2;
  image.data = {7, 8};
  image.nmetadata = 1;
  image.metadata.resize(1);
  image.metadata[0].key = "seq";
  image.metadata[0].n = 8;
  image.metadata[0].value = {0, 0, 0, 0, 0, 0, 1, 2};
  return image;
}

// Offset of image_t's fields: fingerprint, utime, four int32, then size, two
// bytes of data, nmetadata.
constexpr std::size_t kSizeAt = 8 + 8 + 4 * 4;
constexpr std::size_t kNumMetadataAt = kSizeAt + 4 + 2;
constexpr std::size_t kKeyLengthAt = kNumMetadataAt + 4;

TEST(DecodeMessage, RoundTrip) {
  const auto decoded = DecodeMessage<image_t>(Encode(SmallImage()));
  ASSERT_TRUE(decoded.has_value());
  EXPECT_EQ(decoded->data, SmallImage().data);
  EXPECT_EQ(decoded->metadata[0].key, "seq");
}

TEST(DecodeMessage, EveryCutIsRefused) {
  const Bytes whole = Encode(SmallImage());
  for (std::size_t size = 0; size < whole.size(); ++size) {
    const Bytes cut(whole.begin(),
                    whole.begin() + static_cast<std::ptrdiff_t>(size));
    EXPECT_FALSE(DecodeMessage<image_t>(cut).has_value()) << size;
  }
}

TEST(DecodeMessage, BytesLeftOverAreRefused) {
  Bytes data = Encode(SmallImage());
  data.push_back(0);
  EXPECT_FALSE(DecodeMessage<image_t>(data).has_value());
}

TEST(DecodeMessage, AnotherTypeIsRefused) {
  EXPECT_FALSE(DecodeMessage<encoders_t>(Encode(SmallImage())).has_value());
}

// As lcm-gen writes it, decode() would throw on the negative ones, and take
// up to 120 GB for the others.
TEST(DecodeMessage, ImpossibleLengthsAreRefusedWithoutTakingMemory) {
  for (const std::size_t at : {kSizeAt, kNumMetadataAt, kKeyLengthAt}) {
    for (const std::uint32_t length :
         {0u, 200u, 0x40000000u, 0x7fffffffu, 0x80000000u, 0xffffffffu}) {
      Bytes data = Encode(SmallImage());
      PutInt32(&data, at, length);
      EXPECT_FALSE(DecodeMessage<image_t>(data).has_value())
          << at << " " << length;
    }
  }
}

TEST(DecodeMessage, TextWithoutItsTerminatingZeroIsRefused) {
  Bytes data = Encode(SmallImage());
  // Length of the key (with its zero), then its bytes.
  const std::size_t last = kKeyLengthAt + 4 + 3;
  ASSERT_EQ(data.at(last), 0);
  data.at(last) = 'x';
  EXPECT_FALSE(DecodeMessage<image_t>(data).has_value());
}

TEST(DecodeMessage, FieldsNotSetAreZero) {
  const auto decoded = DecodeMessage<status_t>(Encode(status_t()));
  ASSERT_TRUE(decoded.has_value());
  EXPECT_EQ(decoded->has_timing, 0);
  EXPECT_EQ(decoded->clock_offset_us, 0);
}

TEST(SequenceOf, FromFieldOrImageMetadata) {
  encoders_t encoders;
  encoders.seq = 12;
  EXPECT_EQ(SequenceOf(encoders), 12);
  EXPECT_EQ(SequenceOf(SmallImage()), 258);
  image_t without = SmallImage();
  without.metadata[0].key = "tilt";
  EXPECT_EQ(SequenceOf(without), -1);
  // A value of another width is not a sequence number.
  image_t narrow = SmallImage();
  narrow.metadata[0].value.resize(4);
  EXPECT_EQ(SequenceOf(narrow), -1);
}

TEST(SenderOf, SourceOrProcessOrNone) {
  position_fix_t fix;
  fix.source = "camera";
  EXPECT_EQ(SenderOf(fix), "camera");
  status_t status;
  status.process = "pose_filter";
  status.host = "robot";
  status.pid = 12;
  EXPECT_EQ(SenderOf(status), "pose_filter robot 12");
  EXPECT_EQ(SenderOf(encoders_t()), "");
}

}  // namespace
}  // namespace waymark
