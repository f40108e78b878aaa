// Learned wheel parameters on disk, so that the next run starts from them.
#pragma once

#include "estimation/filter/estimate_types.h"

#include <optional>
#include <string>

namespace waymark {

// nullopt where there is no such file. Throws InputError with one line (file,
// key, value, allowed range) where it cannot be read or is no such file.
[[nodiscard]] std::optional<OdometryParameters> LoadParameterFile(
    const std::string& path);

// Throws InputError where nothing can be written into the folder of `path`.
void CheckParameterFolder(const std::string& path);

// Writes beside it and renames, so that a reader, or the next run after a
// crash or on a full disk, finds either the old file or the new one. Loads
// back bit for bit. Throws InputError with one line.
void SaveParameterFile(const std::string& path,
                       const OdometryParameters& parameters);

}  // namespace waymark
