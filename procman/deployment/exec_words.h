// What a command's exec string runs: words, without a shell.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace waymark {

struct ExecWords {
  // Leading NAME=VALUE words, in order: of the child's environment.
  std::vector<std::pair<std::string, std::string>> environment;
  std::vector<std::string> words;  // The program and its arguments.
};

// Value of a variable of the environment; nullopt where there is none.
using FindVariable =
    std::function<std::optional<std::string>(std::string_view name)>;

// Splits `exec` at blanks as stock deputies do: ' and " quote, a backslash
// takes the next character as it is, within quotes too. Then $NAME and ${NAME}
// of `variables` are put in, in the program and its arguments, even where they
// were quoted; unknown ones, and those whose $ stood behind a backslash, stay
// as they are. Not in the values of the leading words, which the program's own
// variables do not see either. Pipes, globs and ; are plain text: use
// bash -c '...'.
//
// Throws std::invalid_argument: no program, an open quote, a backslash at the
// end, a zero byte.
[[nodiscard]] ExecWords SplitExec(std::string_view exec,
                                  const FindVariable& variables);

}  // namespace waymark
