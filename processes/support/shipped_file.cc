#include "processes/support/shipped_file.h"

#include "estimation/base/input_error.h"

#include <array>
#include <filesystem>
#include <system_error>

namespace waymark {
namespace {

namespace fs = std::filesystem;

std::array<fs::path, 2> PlacesOf(std::string_view folder,
                                 std::string_view source_folder) {
  std::error_code error;
  // build/bin/simulator and build/tests/...: the source is two folders up.
  const fs::path above =
      fs::read_symlink("/proc/self/exe", error).parent_path().parent_path();
  return {above / "share/waymark" / folder,
          above.parent_path() / source_folder};
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
  for (const fs::path& place : PlacesOf(folder, source_folder)) {
    const fs::path path = place / (name + std::string(extension));
    if (fs::is_regular_file(path, error)) return path.string();
  }
  std::string list;
  for (const std::string& known :
       ShippedNames(folder, source_folder, extension)) {
    list += (list.empty() ? "" : ", ") + known;
  }
  throw InputError("'" + name + "' is neither a file nor one of the " +
                   std::string(folder) + ": " + list);
}

std::set<std::string> ShippedNames(std::string_view folder,
                                   std::string_view source_folder,
                                   std::string_view extension) {
  std::error_code error;
  std::set<std::string> names;
  for (const fs::path& place : PlacesOf(folder, source_folder)) {
    for (const auto& entry : fs::directory_iterator(place, error)) {
      if (entry.path().extension() == extension) {
        names.insert(entry.path().stem().string());
      }
    }
  }
  return names;
}

}  // namespace waymark
