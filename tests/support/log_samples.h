// The logs of logs/samples: simulated drives, written as messages.
#pragma once

#include "estimation/filter/differential_drive.h"
#include "processes/support/log_file.h"

#include <string>
#include <vector>

namespace waymark {

// The true parameters of every sample. The nominal ones in the logs are wrong:
// k_right 3 % high, k_left 2 % low, wheel_base 6 % low.
[[nodiscard]] WheelParameters SampleTruth();

// "zigzag.log", "square.log", "scan_matched.log".
[[nodiscard]] std::vector<std::string> SampleNames();

// Makes one of them, the same bytes every time. Throws std::logic_error for
// another name, InputError where `path` cannot be written.
void WriteSample(const std::string& name,
                 const std::string& path,
                 IfExists if_exists);

}  // namespace waymark
