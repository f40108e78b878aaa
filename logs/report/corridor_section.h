// What was seen of a corridor, as a part of the report.
#pragma once

#include "logs/evaluation/log_evaluation.h"

#include <string>

namespace waymark {

// Lateral position over time; some of the images with their lines and the
// vanishing point, from the first to the last; how many answers of each kind,
// and what they took. Empty without CORRIDOR_POSE.
[[nodiscard]] std::string CorridorSection(const LogEvaluation& evaluation);

// Whether CorridorSection() has the images of this channel.
[[nodiscard]] bool ShowsLinesOf(const LogEvaluation& evaluation,
                                const std::string& channel);

}  // namespace waymark
