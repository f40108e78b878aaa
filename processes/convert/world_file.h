// World files.
#pragma once

#include "drivers/simulator/world.h"

#include <set>
#include <string>
#include <string_view>

namespace waymark {

// YAML, read as strictly as a configuration; drivers/simulator/worlds/README.md
// says what may stand in it. Files that it names are relative to its own
// folder; ${NAME} in their paths is the environment variable NAME.
//
// Throws InputError with one line (file, line, object, key, value, allowed
// range) for what is unknown, given twice, missing, of a wrong type or out of
// range. What does not fit together is found by BuildScene().
[[nodiscard]] World LoadWorldFile(const std::string& path);
// The same from text; `source` names it in errors, its folder is that of the
// files it names.
[[nodiscard]] World WorldFromYaml(const std::string& yaml,
                                  const std::string& source);

// As FindShippedFile(): "office_u" or a path. "random:17" is found too, and is
// what LoadWorldFile() takes for RandomWorld(17); throws InputError where no
// number from 0 on follows.
[[nodiscard]] std::string FindWorldFile(const std::string& name);
// The worlds that come with Waymark.
[[nodiscard]] std::set<std::string> WorldNames();
// What the names of random worlds begin with.
inline constexpr std::string_view kRandomWorld = "random:";

}  // namespace waymark
