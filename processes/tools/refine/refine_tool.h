// waymark-refine: wheel parameters and sensor mounting from recorded logs.
#pragma once

namespace waymark {

// The whole tool; returns the exit code.
//
//   waymark-refine LOG... [--joint] [--set solver key=value]
//                  [--json FILE] [--out params.yaml]
//
// One solution per log, or with --joint one over all of them: shared wheels, a
// mounting of each sensor in each log. Nominal parameters come from each log
// (ODOMETRY_PARAMETERS with source nominal) or from --set nominal=[...].
[[nodiscard]] int RunRefineTool(int argc, char** argv);

}  // namespace waymark
