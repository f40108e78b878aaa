// Files by which a process goes on after its restart.
#pragma once

#include <string>

namespace waymark {

// Throws InputError where nothing can be written into the folder of `path`.
void CheckStateFolder(const std::string& path);

// Writes beside it and renames, so that a reader, or the next run after a
// crash or on a full disk, finds either the old file or the new one. On disk
// when this returns. Throws InputError with one line.
void SaveStateFile(const std::string& path, const std::string& text);

// What SaveStateFile() writes first. One that lies there at the start is the
// rest of a write that was cut short.
[[nodiscard]] std::string UnfinishedStateFile(const std::string& path);

}  // namespace waymark
