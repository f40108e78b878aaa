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

// What LoadParameterFile() reads: the same again, bit for bit.
[[nodiscard]] std::string TextOfParameters(
    const OdometryParameters& parameters);
// As SaveStateFile() does.
void SaveParameterFile(const std::string& path,
                       const OdometryParameters& parameters);

}  // namespace waymark
