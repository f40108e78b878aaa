// Files that come with Waymark.
#pragma once

#include <set>
#include <string>
#include <string_view>

namespace waymark {

// Path of a file by name or path: a name without a slash that is no file is
// looked for, with `extension` behind it, in `folder` below the installed
// programs' share/waymark, and in `source_folder` of the source that this
// program was built from. Throws InputError that lists the names there are.
//
//   FindShippedFile("mirror", "cameras", "drivers/simulator/cameras", ".yaml")
[[nodiscard]] std::string FindShippedFile(const std::string& name,
                                          std::string_view folder,
                                          std::string_view source_folder,
                                          std::string_view extension);

// The names that it knows.
[[nodiscard]] std::set<std::string> ShippedNames(std::string_view folder,
                                                 std::string_view source_folder,
                                                 std::string_view extension);

}  // namespace waymark
