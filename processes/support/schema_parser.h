// Parser of LCM's message definition language.
#pragma once

#include "processes/support/message_schema.h"

#include <string_view>
#include <vector>

namespace waymark {

// The structs of one .lcm file, in their order; `nested` is not yet resolved.
// Throws InputError with "file:line: what".
[[nodiscard]] std::vector<MessageSchema> ParseSchemas(std::string_view text,
                                                      const std::string& file);

}  // namespace waymark
