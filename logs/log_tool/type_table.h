// Which type a message is of: the built-in types and those of the user's .lcm
// files.
#pragma once

#include "processes/support/message_schema.h"

#include <cstdint>
#include <map>
#include <span>
#include <string>

namespace waymark {

struct MessageTypeInfo {
  // "waymark.pose_t"; "waymark.image_t = bot_core.image_t" where several have
  // the same members; "? 0123456789abcdef" or "no fingerprint" if unknown;
  // "LCM self test" for what LCM sends itself at its start.
  std::string name;
  const MessageSchema* schema = nullptr;  // nullptr: unknown.
  bool is_self_test = false;
  bool is_ours = false;  // Of package waymark, and of that alone.
  bool has_sequence = false;
};

class TypeTable {
 public:
  // `user_folder` holds further .lcm files, "" for none; they come before the
  // built-in types. Throws InputError.
  explicit TypeTable(const std::string& user_folder);

  // The type of a message by its first eight bytes. The result lives as long
  // as the table.
  const MessageTypeInfo& Find(std::span<const std::uint8_t> data);

 private:
  [[nodiscard]] MessageTypeInfo Describe(std::uint64_t fingerprint) const;

  SchemaSet user_;
  SchemaSet built_in_;
  MessageTypeInfo none_;
  std::map<std::uint64_t, MessageTypeInfo> known_;
};

}  // namespace waymark
