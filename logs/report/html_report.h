// One self-contained HTML page about one or several evaluated logs.
#pragma once

#include "logs/evaluation/log_evaluation.h"

#include <span>
#include <string>

namespace waymark {

// To be shown above the evaluations: a plan of where it was, say.
struct ReportPicture {
  std::string caption;
  ImageFile file;
};

// Throws InputError where the file cannot be read, or is neither a PNG nor a
// JPEG by its first bytes.
[[nodiscard]] ReportPicture LoadReportPicture(const std::string& path,
                                              const std::string& caption);

// Inline style, inline SVG and inline pictures only: opens offline, light and
// dark, wide and narrow. Same evaluations and pictures, same bytes.
[[nodiscard]] std::string HtmlReport(std::span<const LogEvaluation> evaluations,
                                     std::span<const ReportPicture> pictures);

}  // namespace waymark
