// The plots of one evaluated log.
#pragma once

#include "logs/evaluation/log_evaluation.h"
#include "logs/report/svg_plot.h"

#include <vector>

namespace waymark {

[[nodiscard]] Plot TrajectoryPlot(const LogEvaluation& evaluation);
[[nodiscard]] Plot PositionErrorPlot(const LogEvaluation& evaluation);
[[nodiscard]] Plot HeadingErrorPlot(const LogEvaluation& evaluation);
[[nodiscard]] Plot NeesPlot(const LogEvaluation& evaluation);
// Lateral position in the corridor over time: true, believed, seen. Only where
// the log has CORRIDOR_POSE.
[[nodiscard]] Plot CorridorPlot(const LogEvaluation& evaluation);
// k_right, k_left, wheel base over time with bands of two sigma.
[[nodiscard]] std::vector<Plot> ParameterPlots(const LogEvaluation& evaluation);

}  // namespace waymark
