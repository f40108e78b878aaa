// Places as a user names them.
#pragma once

#include "processes/convert/task_convert.h"

#include <string>

namespace waymark {

// "x,y" or "x,y,heading in degrees", m in W. Throws InputError.
[[nodiscard]] Waypoint WaypointFromText(const std::string& text);

}  // namespace waymark
