// One self-contained HTML page about one or several evaluated logs.
#pragma once

#include "logs/evaluation/log_evaluation.h"

#include <span>
#include <string>

namespace waymark {

// Inline style and inline SVG only: opens offline, light and dark, wide and
// narrow. Same evaluations, same bytes.
[[nodiscard]] std::string HtmlReport(
    std::span<const LogEvaluation> evaluations);

}  // namespace waymark
