// One channel's poses as a trajectory in TUM's format.
#pragma once

#include "logs/log_tool/type_table.h"
#include "processes/support/output_file.h"

#include <cstdint>
#include <string>

namespace waymark {

struct TumReport {
  std::int64_t num_poses = 0;
  std::int64_t num_unknown = 0;     // Messages that say they know no pose.
  std::int64_t num_no_heading = 0;  // Written with the identity rotation.
};

// Writes lines "time x y z qx qy qz qw": seconds since the epoch with six
// decimals, metres, unit quaternion. A pose is found in any type by its fields:
// pose_W[3]; x, y and heading or theta; pos[3] and orientation[4], or trans[3]
// and quat[4], quaternions as w, x, y, z. The time is the message's utime, or
// the event's where it has none or `by_event_time` (for recordings whose utimes
// come from another clock).
//
// Throws InputError where reading or writing fails, `out` exists (kFail) or is
// the log, the channel is missing (the message lists those there are), its type
// is unknown, has no pose, or a message does not decode.
TumReport ExportTum(const std::string& log,
                    const std::string& channel,
                    const std::string& out,
                    bool by_event_time,
                    TypeTable* types,
                    IfExists if_exists = IfExists::kFail);

}  // namespace waymark
