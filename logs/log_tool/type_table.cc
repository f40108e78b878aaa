#include "logs/log_tool/type_table.h"

#include "processes/support/decode.h"

#include <algorithm>
#include <cstdio>

namespace waymark {
namespace {

// The first eight letters of "lcm self test".
constexpr std::uint64_t kSelfTest = 0x6c636d2073656c66;

// Counted messages have seq; images carry theirs in the metadata.
bool HasSequence(const MessageSchema& schema) {
  return std::any_of(
      schema.fields.begin(), schema.fields.end(), [](const SchemaField& f) {
        return (f.name == "seq" && f.dimensions.empty()) ||
               (f.nested != nullptr &&
                f.nested->name.ends_with(".image_metadata_t"));
      });
}

}  // namespace

TypeTable::TypeTable(const std::string& user_folder)
    : user_(user_folder.empty() ? std::vector<SchemaSet::Source>{}
                                : ReadSchemaFolder(user_folder)),
      built_in_(BuiltInSchemaSources()) {
  none_.name = "no fingerprint";
}

const MessageTypeInfo& TypeTable::Find(std::span<const std::uint8_t> data) {
  const auto fingerprint = BigEndian64(data);
  if (!fingerprint) return none_;
  const auto found = known_.find(*fingerprint);
  if (found != known_.end()) return found->second;
  return known_.emplace(*fingerprint, Describe(*fingerprint)).first->second;
}

MessageTypeInfo TypeTable::Describe(std::uint64_t fingerprint) const {
  auto types = user_.FindByFingerprint(fingerprint);
  const auto built_in = built_in_.FindByFingerprint(fingerprint);
  types.insert(types.end(), built_in.begin(), built_in.end());
  MessageTypeInfo info;
  if (fingerprint == kSelfTest) {
    info.name = "LCM self test";
    info.is_self_test = true;
    return info;
  }
  if (types.empty()) {
    char text[32];
    std::snprintf(text,
                  sizeof(text),
                  "? %016llx",
                  static_cast<unsigned long long>(fingerprint));
    info.name = text;
    return info;
  }
  for (const auto* type : types) {
    if (info.name.find(type->name) != std::string::npos) continue;
    info.name += (info.name.empty() ? "" : " = ") + type->name;
  }
  info.schema = types.front();
  info.is_ours = info.name == info.schema->name &&
                 info.schema->name.starts_with("waymark.");
  info.has_sequence = HasSequence(*info.schema);
  return info;
}

}  // namespace waymark
