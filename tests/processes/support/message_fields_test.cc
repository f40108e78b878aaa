#include "processes/support/message_fields.h"

#include "estimation/base/random.h"

#include <waymark/image_t.hpp>
#include <waymark/status_t.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <tuple>

namespace waymark {
namespace {

using testing::HasSubstr;
using Bytes = std::vector<std::uint8_t>;

const SchemaSet& BuiltIn() {
  static const SchemaSet kSet(BuiltInSchemaSources());
  return kSet;
}

SchemaSet Parse(const std::string& text) {
  return SchemaSet(std::vector<SchemaSet::Source>{{"x", text}});
}

template <typename M>
Bytes Encode(const M& message) {
  Bytes data(static_cast<std::size_t>(message.getEncodedSize()));
  message.encode(data.data(), 0, static_cast<int>(data.size()));
  return data;
}

struct Visited {
  std::string reason;
  std::map<std::string, std::string> values;
};

Visited Visit(const MessageSchema& schema, const Bytes& data) {
  Visited result;
  result.reason = VisitFields(
      schema, data, [&](std::string_view name, const FieldValue& value) {
        std::string text;
        if (const auto* integer = std::get_if<std::int64_t>(&value)) {
          text = std::to_string(*integer);
        } else if (const auto* number = std::get_if<double>(&value)) {
          text = std::to_string(*number);
        } else if (const auto* flag = std::get_if<bool>(&value)) {
          text = *flag ? "true" : "false";
        } else if (const auto* words = std::get_if<std::string_view>(&value)) {
          text = *words;
        } else {
          text = std::to_string(
                     std::get<std::span<const std::uint8_t>>(value).size()) +
                 " bytes";
        }
        result.values[std::string(name)] = text;
      });
  return result;
}

status_t SomeStatus() {
  status_t status{};
  status.utime = 123456789012345;
  status.process = "pose_filter";
  status.worst_handler_us = -1;
  status.num_channels = 2;
  status.channels.resize(2);
  status.channels[1].channel = "ENCODERS";
  status.channels[1].num_lost = 7;
  return status;
}

TEST(MessageFieldsTest, VisitsNestedNamedValues) {
  const auto visited =
      Visit(*BuiltIn().FindByName("waymark.status_t"), Encode(SomeStatus()));
  EXPECT_EQ(visited.reason, "");
  EXPECT_EQ(visited.values.at("utime"), "123456789012345");
  EXPECT_EQ(visited.values.at("process"), "pose_filter");
  EXPECT_EQ(visited.values.at("worst_handler_us"), "-1");
  EXPECT_EQ(visited.values.at("channels[1].channel"), "ENCODERS");
  EXPECT_EQ(visited.values.at("channels[1].num_lost"), "7");
  const std::size_t num_own =
      BuiltIn().FindByName("waymark.status_t")->fields.size() - 1;
  const std::size_t num_nested =
      BuiltIn().FindByName("waymark.channel_status_t")->fields.size();
  EXPECT_EQ(visited.values.size(), num_own + 2 * num_nested);
}

TEST(MessageFieldsTest, BytesAreOneValue) {
  image_t image{};
  image.size = 1000;
  image.data.assign(1000, 9);
  const auto visited =
      Visit(*BuiltIn().FindByName("waymark.image_t"), Encode(image));
  EXPECT_EQ(visited.reason, "");
  EXPECT_EQ(visited.values.at("data"), "1000 bytes");
}

TEST(MessageFieldsTest, ArraysOfSeveralDimensions) {
  const SchemaSet set = Parse("struct a_t { int8_t n; int16_t g[n][2]; }");
  const Bytes data = {0, 0, 0, 0, 0, 0, 0, 0, 2, 0, 1, 0, 2, 0xff, 0xff, 0, 4};
  const auto visited = Visit(*set.FindByName("a_t"), data);
  EXPECT_EQ(visited.reason, "");
  EXPECT_EQ(visited.values.at("g[0][1]"), "2");
  EXPECT_EQ(visited.values.at("g[1][0]"), "-1");
}

TEST(MessageFieldsTest, EveryTruncationSaysWhy) {
  const Bytes data = Encode(SomeStatus());
  const auto& schema = *BuiltIn().FindByName("waymark.status_t");
  for (std::size_t length = 0; length < data.size(); ++length) {
    const Bytes cut(data.begin(),
                    data.begin() + static_cast<std::ptrdiff_t>(length));
    EXPECT_NE(Visit(schema, cut).reason, "") << length;
  }
  Bytes longer = data;
  longer.push_back(0);
  EXPECT_EQ(Visit(schema, longer).reason, "1 bytes are left over");
}

TEST(MessageFieldsTest, HostileLengthsAreRefusedAtOnce) {
  status_t status = SomeStatus();
  status.num_channels = 0;
  status.channels.clear();
  Bytes data = Encode(status);
  const auto& schema = *BuiltIn().FindByName("waymark.status_t");
  data[data.size() - 4] = 0x80;
  EXPECT_THAT(Visit(schema, data).reason, HasSubstr("num_channels is -2"));
  data[data.size() - 4] = 0x7f;
  EXPECT_THAT(Visit(schema, data).reason, HasSubstr("channels"));
}

// Types whose elements take no bytes, and types within themselves.
TEST(MessageFieldsTest, HostileTypesTakeBoundedTime) {
  const SchemaSet set = Parse(
      "struct e_t { }"
      "struct a_t { e_t x[60000]; }"
      "struct b_t { a_t x[60000]; }"
      "struct c_t { int32_t n; b_t x[n][n][n]; }"
      "struct node_t { int32_t n; node_t children[n]; }");
  Bytes data(8 + 400'000, 0);
  EXPECT_THAT(Visit(*set.FindByName("b_t"), data).reason, HasSubstr("longer"));
  data[9] = 0x7f;
  EXPECT_THAT(Visit(*set.FindByName("c_t"), data).reason, HasSubstr("longer"));
  for (std::size_t i = 8; i < data.size(); ++i) data[i] = i % 4 == 3 ? 1 : 0;
  EXPECT_THAT(Visit(*set.FindByName("node_t"), data).reason,
              HasSubstr("deeply"));
}

TEST(MessageFieldsTest, RandomBytesNeverPassTheEnd) {
  Random random(1);
  for (int i = 0; i < 500; ++i) {
    Bytes data(random.Index(200));
    for (auto& byte : data) {
      // Mostly small numbers, so that lengths are believable now and then.
      byte = static_cast<std::uint8_t>(random.Index(4) == 0 ? random.Index(256)
                                                            : random.Index(3));
    }
    for (const auto* schema : BuiltIn().types()) {
      std::ignore = VisitFields(
          *schema, data, [&](std::string_view, const FieldValue& v) {
            if (const auto* text = std::get_if<std::string_view>(&v)) {
              EXPECT_LE(text->size(), data.size());
            }
          });
    }
  }
}

}  // namespace
}  // namespace waymark
