#include "processes/support/message_fields.h"

#include <bit>
#include <optional>

namespace waymark {
namespace {

constexpr std::size_t kFingerprintBytes = 8;
// A type may contain itself; real ones nest three or four deep.
constexpr int kMaxDepth = 32;

std::size_t BytesOf(FieldKind kind) {
  switch (kind) {
    case FieldKind::kBoolean:
    case FieldKind::kByte:
    case FieldKind::kInt8:
      return 1;
    case FieldKind::kInt16:
      return 2;
    case FieldKind::kInt32:
    case FieldKind::kFloat:
    case FieldKind::kString:  // Its length.
      return 4;
    case FieldKind::kInt64:
    case FieldKind::kDouble:
      return 8;
    case FieldKind::kStruct:
      return 0;
  }
  return 0;
}

// Thrown within this file only: the reason why a message does not decode.
struct Malformed {
  std::string reason;
};

class Walker {
 public:
  Walker(std::span<const std::uint8_t> data, const FieldVisitor& visit)
      : rest_(data),
        visit_(visit),
        // Every value takes a byte at least, except structs, which are few;
        // types without members in long arrays would take none.
        steps_left_(4 * data.size() + 1000) {}

  void VisitStruct(const MessageSchema& schema, int depth) {
    if (depth > kMaxDepth) throw Malformed{"it nests too deeply"};
    // Values of the integer members: lengths of arrays that follow.
    std::vector<std::int64_t> integers(schema.fields.size(), 0);
    const std::size_t prefix = path_.size();
    for (std::size_t i = 0; i < schema.fields.size(); ++i) {
      const auto& field = schema.fields[i];
      path_ += prefix == 0 ? "" : ".";
      path_ += field.name;
      if (field.dimensions.empty()) {
        integers[i] = VisitValue(field, depth);
      } else {
        VisitArray(field, integers, depth);
      }
      path_.resize(prefix);
    }
  }

  [[nodiscard]] std::size_t num_bytes_left() const { return rest_.size(); }

 private:
  void VisitArray(const SchemaField& field,
                  const std::vector<std::int64_t>& integers,
                  int depth) {
    std::vector<std::int64_t> lengths;
    std::uint64_t total = 1;
    for (const auto& dimension : field.dimensions) {
      const std::int64_t length =
          dimension.length_field < 0
              ? dimension.length
              : integers[static_cast<std::size_t>(dimension.length_field)];
      if (length < 0) {
        throw Malformed{dimension.size + " is " + std::to_string(length)};
      }
      lengths.push_back(length);
    }
    for (const std::int64_t length : lengths) {
      if (length == 0) return;
    }
    for (const std::int64_t length : lengths) {
      const auto n = static_cast<std::uint64_t>(length);
      // Each element takes one byte or one step.
      if (n > steps_left_ / total) throw TooLong(field.name);
      total *= n;
    }
    const std::size_t size = BytesOf(field.kind);
    if (size > 0 && total > rest_.size() / size) throw TooLong(field.name);
    VisitDimension(field, lengths, depth);
  }

  Malformed TooLong(const std::string& name) const {
    return {name + " is longer than the message's other " +
            std::to_string(rest_.size()) + " bytes"};
  }

  void VisitDimension(const SchemaField& field,
                      std::span<const std::int64_t> lengths,
                      int depth) {
    const auto n = static_cast<std::size_t>(lengths[0]);
    if (lengths.size() == 1 && field.kind == FieldKind::kByte) {
      visit_(path_, FieldValue(Take(n)));
      return;
    }
    const std::size_t prefix = path_.size();
    for (std::size_t i = 0; i < n; ++i) {
      path_ += '[';
      path_ += std::to_string(i);
      path_ += ']';
      if (lengths.size() > 1) {
        VisitDimension(field, lengths.subspan(1), depth);
      } else {
        VisitValue(field, depth);
      }
      path_.resize(prefix);
    }
  }

  // Returns the value of an integer, 0 for anything else.
  std::int64_t VisitValue(const SchemaField& field, int depth) {
    if (steps_left_ == 0) throw Malformed{"it has too many parts"};
    --steps_left_;
    switch (field.kind) {
      case FieldKind::kStruct:
        VisitStruct(*field.nested, depth + 1);
        return 0;
      case FieldKind::kString:
        visit_(path_, FieldValue(TakeString()));
        return 0;
      case FieldKind::kBoolean:
        visit_(path_, FieldValue(TakeBits(1) != 0));
        return 0;
      case FieldKind::kFloat: {
        const auto bits = static_cast<std::uint32_t>(TakeBits(4));
        visit_(path_, FieldValue(std::bit_cast<float>(bits)));
        return 0;
      }
      case FieldKind::kDouble:
        visit_(path_, FieldValue(std::bit_cast<double>(TakeBits(8))));
        return 0;
      default:
        break;
    }
    const std::int64_t value = TakeInteger(field.kind);
    visit_(path_, FieldValue(value));
    return value;
  }

  std::int64_t TakeInteger(FieldKind kind) {
    switch (kind) {
      case FieldKind::kByte:
        return static_cast<std::uint8_t>(TakeBits(1));
      case FieldKind::kInt8:
        return static_cast<std::int8_t>(TakeBits(1));
      case FieldKind::kInt16:
        return static_cast<std::int16_t>(TakeBits(2));
      case FieldKind::kInt32:
        return static_cast<std::int32_t>(TakeBits(4));
      default:
        return static_cast<std::int64_t>(TakeBits(8));
    }
  }

  std::span<const std::uint8_t> Take(std::size_t n) {
    if (n > rest_.size()) {
      throw Malformed{"it ends within " + path_};
    }
    const auto bytes = rest_.first(n);
    rest_ = rest_.subspan(n);
    return bytes;
  }

  std::uint64_t TakeBits(std::size_t n) {
    std::uint64_t bits = 0;
    for (const std::uint8_t byte : Take(n)) bits = bits << 8 | byte;
    return bits;
  }

  std::string_view TakeString() {
    const std::int64_t size = static_cast<std::int32_t>(TakeBits(4));
    if (size < 1) {
      throw Malformed{"the length of " + path_ + " is " + std::to_string(size)};
    }
    const auto bytes = Take(static_cast<std::size_t>(size));
    if (bytes.back() != 0) {
      throw Malformed{"the text of " + path_ + " has no end"};
    }
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size() - 1};
  }

  std::span<const std::uint8_t> rest_;
  const FieldVisitor& visit_;
  std::uint64_t steps_left_;
  std::string path_;
};

}  // namespace

std::string VisitFields(const MessageSchema& schema,
                        std::span<const std::uint8_t> data,
                        const FieldVisitor& visit) {
  if (data.size() < kFingerprintBytes) return "it has no fingerprint";
  Walker walker(data.subspan(kFingerprintBytes), visit);
  try {
    walker.VisitStruct(schema, 0);
  } catch (const Malformed& malformed) {
    return malformed.reason;
  }
  if (walker.num_bytes_left() > 0) {
    return std::to_string(walker.num_bytes_left()) + " bytes are left over";
  }
  return "";
}

}  // namespace waymark
