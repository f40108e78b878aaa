// Any message as named values, by its schema, without generated code.
#pragma once

#include "processes/support/message_schema.h"

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <variant>

namespace waymark {

// Views into the message's bytes. An array of bytes is one value.
using FieldValue = std::variant<std::int64_t,
                                float,
                                double,
                                bool,
                                std::string_view,
                                std::span<const std::uint8_t>>;

// Called in the order of the members; `name` is "pose_W[2]" or
// "channels[0].num_lost".
using FieldVisitor =
    std::function<void(std::string_view name, const FieldValue& value)>;

// Visits all values of a message, `data` starting with its fingerprint (which
// is not looked at). Empty result: it decoded to exactly its length. Otherwise
// why it did not, such as "num_channels is -3"; values before that point were
// visited.
//
// Made for bytes from anywhere: allocates nothing that grows with a length
// field, and its time is bounded by the length of `data`.
[[nodiscard]] std::string VisitFields(const MessageSchema& schema,
                                      std::span<const std::uint8_t> data,
                                      const FieldVisitor& visit);

}  // namespace waymark
