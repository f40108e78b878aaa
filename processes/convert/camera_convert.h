// CAMERA_INFO_<camera> to what is known of a camera, and back.
#pragma once

#include "estimation/base/time.h"
#include "processes/convert/camera_file.h"

#include <waymark/camera_info_t.hpp>

#include <cstdint>
#include <optional>
#include <string>

namespace waymark {

// `name` as in IMAGE_<name>.
[[nodiscard]] camera_info_t ToMessage(const CameraDescription& camera,
                                      const std::string& name,
                                      Time time,
                                      std::int64_t seq);

// Returns nullopt and sets *reason (what, value, allowed range) where the time
// is not positive, the model is unknown, its numbers are not those of
// ParameterNames() or make no camera, the size is not in 1 to 20000 px, or the
// mounting is not finite, within 100 m and a unit quaternion. `reason` must not
// be null.
[[nodiscard]] std::optional<CameraDescription> CameraFromMessage(
    const camera_info_t& message, std::string* reason);

}  // namespace waymark
