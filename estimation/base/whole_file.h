// Files read at once.
#pragma once

#include <cstddef>
#include <string>

namespace waymark {

// The content of a regular file, or of a pipe, of at most `max_bytes`. Throws
// InputError naming the file where it cannot be read to its end or is longer.
[[nodiscard]] std::string ReadWholeFile(const std::string& path,
                                        std::size_t max_bytes);

}  // namespace waymark
