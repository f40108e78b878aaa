#include "processes/support/shipped_file.h"

#include "estimation/base/input_error.h"

#include <filesystem>
#include <set>
#include <system_error>

namespace waymark {
namespace {

namespace fs = std::filesystem;

// build/bin/simulator and build/tests/...: the source is two folders up.
fs::path AboveProgram() {
  std::error_code error;
  return fs::read_symlink("/proc/self/exe", error).parent_path().parent_path();
}

}  // namespace

std::string FindShippedFile(const std::string& name,
                            std::string_view folder,
                            std::string_view source_folder,
                            std::string_view extension) {
  std::error_code error;
  if (name.find('/') != std::string::npos || fs::is_regular_file(name, error)) {
    return name;
  }
  const fs::path above = AboveProgram();
  std::set<std::string> known;
  for (const fs::path& place : {above / "share/waymark" / folder,
                                above.parent_path() / source_folder}) {
    const fs::path path = place / (name + std::string(extension));
    if (fs::is_regular_file(path, error)) return path.string();
    for (const auto& entry : fs::directory_iterator(place, error)) {
      if (entry.path().extension() == extension) {
        known.insert(entry.path().stem().string());
      }
    }
  }
  std::string list;
  for (const std::string& k : known) list += (list.empty() ? "" : ", ") + k;
  throw InputError("'" + name + "' is neither a file nor one of the " +
                   std::string(folder) + ": " + list);
}

}  // namespace waymark
