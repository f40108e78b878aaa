// Message types as data: reads .lcm definitions, computes the fingerprints that
// lcm-gen would, and finds a type by the first eight bytes of a message.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace waymark {

enum class FieldKind {
  kBoolean,
  kByte,
  kInt8,
  kInt16,
  kInt32,
  kInt64,
  kFloat,
  kDouble,
  kString,
  kStruct,
};

struct MessageSchema;

struct SchemaField {
  struct Dimension {
    std::string size;         // As written: a number or a field's name.
    std::int64_t length = 0;  // Where it is a number.
    int length_field = -1;    // Else the index of the field that holds it.
  };
  std::string name;
  std::string type;  // "double", or the full name of a struct.
  FieldKind kind = FieldKind::kByte;
  const MessageSchema* nested = nullptr;  // Where kind is kStruct.
  std::vector<Dimension> dimensions;      // Empty: a single value.
};

struct MessageSchema {
  std::string name;    // "waymark.pose_t".
  std::string origin;  // "file:line" of its definition.
  std::vector<SchemaField> fields;
};

// A closed set of types: every struct that a type contains is in it, too.
class SchemaSet {
 public:
  // One .lcm file's text and the name to show in errors.
  struct Source {
    std::string name;
    std::string text;
  };

  SchemaSet() = default;
  // Throws InputError with "file:line: what" where a definition is malformed,
  // contradicts another one, or uses a type that is not there. Enums, which
  // LCM itself advises against, are not read.
  explicit SchemaSet(const std::vector<Source>& sources);
  SchemaSet(SchemaSet&&) = default;
  SchemaSet& operator=(SchemaSet&&) = default;

  // nullptr where there is none.
  [[nodiscard]] const MessageSchema* FindByName(std::string_view name) const;
  // In order of definition: types with the same members share a fingerprint.
  [[nodiscard]] std::vector<const MessageSchema*> FindByFingerprint(
      std::uint64_t fingerprint) const;
  // In order of definition.
  [[nodiscard]] const std::vector<const MessageSchema*>& types() const {
    return types_;
  }

 private:
  void Resolve();

  std::map<std::string, MessageSchema, std::less<>> by_name_;
  std::multimap<std::uint64_t, const MessageSchema*> by_fingerprint_;
  std::vector<const MessageSchema*> types_;
};

[[nodiscard]] std::uint64_t Fingerprint(const MessageSchema& schema);

// All .lcm files of a folder and of the folders in it. Throws InputError.
[[nodiscard]] std::vector<SchemaSet::Source> ReadSchemaFolder(
    const std::string& folder);

// What was in lcmtypes/ when this was built: Waymark's own types, procman's,
// and common ones by others.
[[nodiscard]] std::vector<SchemaSet::Source> BuiltInSchemaSources();

}  // namespace waymark
