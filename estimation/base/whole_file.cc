#include "estimation/base/whole_file.h"

#include "estimation/base/input_error.h"

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <system_error>
#include <vector>

namespace waymark {

std::string ReadWholeFile(const std::string& path, std::size_t max_bytes) {
  std::error_code error;
  if (std::filesystem::is_directory(path, error)) {
    throw InputError(path + ": is a folder, not a file");
  }
  std::ifstream file(path, std::ios::binary);
  if (!file) {
    throw InputError(path + ": cannot be opened: " + std::strerror(errno));
  }
  std::string content;
  std::vector<char> block(std::size_t{1} << 16U);
  while (file) {
    file.read(block.data(), static_cast<std::streamsize>(block.size()));
    content.append(block.data(), static_cast<std::size_t>(file.gcount()));
    if (content.size() > max_bytes) {
      throw InputError(path + ": is longer than " + std::to_string(max_bytes) +
                       " bytes");
    }
  }
  if (file.bad()) throw InputError(path + ": cannot be read to its end");
  return content;
}

}  // namespace waymark
