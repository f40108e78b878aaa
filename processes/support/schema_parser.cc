#include "processes/support/schema_parser.h"

#include "estimation/base/input_error.h"

#include <array>
#include <charconv>
#include <utility>

namespace waymark {
namespace {

constexpr std::array<std::pair<std::string_view, FieldKind>, 9> kPrimitives = {{
    {"boolean", FieldKind::kBoolean},
    {"byte", FieldKind::kByte},
    {"int8_t", FieldKind::kInt8},
    {"int16_t", FieldKind::kInt16},
    {"int32_t", FieldKind::kInt32},
    {"int64_t", FieldKind::kInt64},
    {"float", FieldKind::kFloat},
    {"double", FieldKind::kDouble},
    {"string", FieldKind::kString},
}};

bool IsInteger(FieldKind kind) {
  return kind == FieldKind::kByte || kind == FieldKind::kInt8 ||
         kind == FieldKind::kInt16 || kind == FieldKind::kInt32 ||
         kind == FieldKind::kInt64;
}

bool IsDigit(char c) {
  return c >= '0' && c <= '9';
}
bool IsWordCharacter(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || IsDigit(c) ||
         c == '_' || c == '.' || c == '+' || c == '-';
}

class Parser {
 public:
  Parser(std::string_view text, const std::string& file)
      : text_(text), file_(file) {}

  std::vector<MessageSchema> Parse() {
    std::vector<MessageSchema> result;
    Advance();
    while (!token_.empty()) {
      if (token_ == "package") {
        Advance();
        package_ = Take("a package name");
        Expect(";");
      } else if (token_ == "struct") {
        result.push_back(ParseStruct());
      } else if (token_ == "enum") {
        Fail("enums are not read (use an int32_t and constants)");
      } else {
        Fail("expected 'package' or 'struct', found '" + token_ + "'");
      }
    }
    return result;
  }

 private:
  [[noreturn]] void Fail(const std::string& what) const {
    throw InputError(Here() + ": " + what);
  }
  [[nodiscard]] std::string Here() const {
    return file_ + ":" + std::to_string(line_);
  }

  void SkipBlanksAndComments() {
    while (position_ < text_.size()) {
      const auto rest = text_.substr(position_);
      if (rest[0] == '\n') ++line_;
      if (rest[0] == ' ' || (rest[0] >= '\t' && rest[0] <= '\r')) {
        ++position_;
      } else if (rest.starts_with("//")) {
        position_ = std::min(text_.find('\n', position_), text_.size());
      } else if (rest.starts_with("/*")) {
        const std::size_t end = text_.find("*/", position_ + 2);
        if (end == std::string_view::npos) Fail("comment without end");
        for (; position_ < end + 2; ++position_) {
          if (text_[position_] == '\n') ++line_;
        }
      } else {
        return;
      }
    }
  }

  // The next word (a name, or a number) or single character; "" at the end.
  void Advance() {
    SkipBlanksAndComments();
    std::size_t end = position_;
    while (end < text_.size() && IsWordCharacter(text_[end])) ++end;
    if (end == position_ && end < text_.size()) ++end;
    token_ = text_.substr(position_, end - position_);
    position_ = end;
  }

  std::string Take(const char* what) {
    if (token_.empty() || !IsWordCharacter(token_[0])) {
      Fail(std::string("expected ") + what + ", found '" + token_ + "'");
    }
    std::string word = token_;
    Advance();
    return word;
  }

  void Expect(std::string_view symbol) {
    if (token_ != symbol) {
      Fail("expected '" + std::string(symbol) + "', found '" + token_ + "'");
    }
    Advance();
  }

  bool Accept(std::string_view symbol) {
    if (token_ != symbol) return false;
    Advance();
    return true;
  }

  MessageSchema ParseStruct() {
    MessageSchema schema;
    schema.origin = Here();
    Advance();
    schema.name = FullName(Take("a struct's name"));
    Expect("{");
    while (!Accept("}")) {
      if (token_.empty()) Fail("struct without closing '}'");
      if (token_ == "const") {
        SkipConstants();
      } else {
        ParseFields(&schema);
      }
    }
    return schema;
  }

  // Constants are not part of a message.
  void SkipConstants() {
    while (!token_.empty() && token_ != ";") Advance();
    Expect(";");
  }

  [[nodiscard]] std::string FullName(const std::string& name) const {
    const bool is_full = name.find('.') != std::string::npos;
    return is_full || package_.empty() ? name : package_ + "." + name;
  }

  void ParseFields(MessageSchema* schema) {
    SchemaField type;
    type.type = Take("a type");
    type.kind = FieldKind::kStruct;
    for (const auto& [name, kind] : kPrimitives) {
      if (type.type == name) type.kind = kind;
    }
    if (type.kind == FieldKind::kStruct) type.type = FullName(type.type);
    do {
      SchemaField field = type;
      field.name = Take("a member's name");
      for (const auto& other : schema->fields) {
        if (other.name == field.name) Fail(field.name + " is there twice");
      }
      while (Accept("[")) {
        field.dimensions.push_back(ParseDimension(*schema));
        Expect("]");
      }
      schema->fields.push_back(std::move(field));
    } while (Accept(","));
    Expect(";");
  }

  SchemaField::Dimension ParseDimension(const MessageSchema& schema) {
    SchemaField::Dimension dimension;
    dimension.size = Take("an array's length");
    const std::string& size = dimension.size;
    if (IsDigit(size[0])) {
      const auto [end, error] = std::from_chars(
          size.data(), size.data() + size.size(), dimension.length);
      if (error != std::errc() || end != size.data() + size.size() ||
          dimension.length < 1) {
        Fail("array length " + size + " is not a positive number");
      }
      return dimension;
    }
    for (std::size_t i = 0; i < schema.fields.size(); ++i) {
      const auto& field = schema.fields[i];
      if (field.name == size && field.dimensions.empty() &&
          IsInteger(field.kind)) {
        dimension.length_field = static_cast<int>(i);
      }
    }
    if (dimension.length_field < 0) {
      Fail("array length " + size + " is no earlier integer member");
    }
    return dimension;
  }

  std::string_view text_;
  std::string file_;
  std::size_t position_ = 0;
  int line_ = 1;
  std::string token_;
  std::string package_;
};

}  // namespace

std::vector<MessageSchema> ParseSchemas(std::string_view text,
                                        const std::string& file) {
  return Parser(text, file).Parse();
}

}  // namespace waymark
