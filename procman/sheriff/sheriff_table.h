// What a sheriff knows, as text.
#pragma once

#include "estimation/base/time.h"
#include "procman/sheriff/sheriff_state.h"

#include <cstdint>
#include <string>

namespace waymark {

// "exit 3", "killed by Terminated".
[[nodiscard]] std::string ExitText(std::int32_t exit_code);

// A line for each deputy, then one for each command. `now` is the steady
// clock's.
[[nodiscard]] std::string StatusTable(const SheriffState& state, Duration now);
[[nodiscard]] std::string StatusJson(const SheriffState& state);

}  // namespace waymark
