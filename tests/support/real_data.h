// Where the recordings by others lie. They are no part of the project.
#pragma once

#include <cstdlib>
#include <filesystem>
#include <string>

namespace waymark {

// Folder `name` of the recordings, in WAYMARK_DATA or beside the project;
// empty where it is not there. Tests that use it carry the label real_data and
// start with
//
//   const std::string folder = RealDataFolder("optiodom_diffdrive");
//   if (folder.empty()) GTEST_SKIP() << "no real recordings";
inline std::string RealDataFolder(const std::string& name) {
  std::filesystem::path root;
  if (const char* data = std::getenv("WAYMARK_DATA")) {
    root = data;
  } else if (const char* source = std::getenv("WAYMARK_SOURCE")) {
    root = std::filesystem::path(source) / ".." / "shared" / "data";
  }
  const std::filesystem::path folder = root / name;
  std::error_code ignored;
  if (root.empty() || !std::filesystem::is_directory(folder, ignored)) {
    return {};
  }
  return folder.lexically_normal().string();
}

}  // namespace waymark
