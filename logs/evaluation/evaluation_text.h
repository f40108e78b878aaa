// An evaluation as text: for people on a terminal, for programs as JSON.
#pragma once

#include "logs/evaluation/log_evaluation.h"

#include <nlohmann/json_fwd.hpp>

#include <span>
#include <string>

namespace waymark {

// Everything about one log, in lines of at most 100 characters.
[[nodiscard]] std::string TableOf(const LogEvaluation& evaluation);

// One line for each log: raw, online and batch side by side.
[[nodiscard]] std::string SummaryTableOf(
    std::span<const LogEvaluation> evaluations);

// The schema "waymark-evaluation-1" of logs/evaluation/README.md.
[[nodiscard]] nlohmann::json JsonOf(const LogEvaluation& evaluation);

// How many POSITION_FIX of which source, with the first one's sigma.
[[nodiscard]] std::string FixesText(const LogRecording& recording);

// "100 100 87 %": how much of the prior variance of k_right, k_left and wheel
// base measurements took away; "-" where that is not known.
[[nodiscard]] std::string ObservabilityText(
    const ParameterConvergence& convergence);

// "no RANGES for 9 s (8 times, from 12.5 s on)": in the words of the last one.
[[nodiscard]] std::string FaultText(const ProcessFault& fault);

// "361.0 ± 2.5", as many decimals as leave two digits of sigma, at most six;
// four decimals and no sigma where that is 0.
[[nodiscard]] std::string WithSigmaText(double value, double sigma);

// 12.3 mm or 1.234 m: three to four digits, the unit that reads best.
[[nodiscard]] std::string MetresText(double metres);
// "98.7 %".
[[nodiscard]] std::string PercentText(double share);

}  // namespace waymark
