#include "logs/report/html_report.h"

#include "estimation/base/input_error.h"
#include "estimation/base/whole_file.h"
#include "estimation/geometry/angle.h"
#include "logs/evaluation/evaluation_text.h"
#include "logs/report/corridor_section.h"
#include "logs/report/evaluation_plots.h"
#include "logs/report/html_parts.h"
#include "logs/report/report_style.h"
#include "logs/report/svg_plot.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <string_view>
#include <vector>

namespace waymark {
namespace {

// What the cameras saw, but for those whose lines are shown.
std::string PicturesOf(const LogEvaluation& evaluation) {
  std::string text;
  const auto& pictures = evaluation.recording.pictures;
  for (const RecordedPicture& picture : pictures) {
    if (ShowsLinesOf(evaluation, picture.channel)) continue;
    text +=
        HtmlFigure(fmt::format("{}, {:.1f} s",
                               picture.channel,
                               Seconds(picture.time - pictures.front().time)),
                   picture.file);
  }
  if (text.empty()) return "";
  return "<h3>Pictures</h3>\n<div class=\"plots three\">\n" + text + "</div>\n";
}

Cell RmseCell(const EstimateEvaluation* estimate) {
  return {estimate != nullptr && estimate->absolute
              ? MetresText(estimate->absolute->position_summary.rmse)
              : "–",
          ""};
}

Cell AlignedCell(const EstimateEvaluation* estimate) {
  return {estimate != nullptr && estimate->aligned
              ? MetresText(estimate->aligned->position_summary.rmse)
              : "–",
          ""};
}

const EstimateEvaluation* RawOf(const LogEvaluation& evaluation) {
  const EstimateEvaluation* raw = evaluation.Find("raw");
  return raw != nullptr && raw->absolute ? raw : evaluation.Find("raw_nominal");
}

std::string Badges(const LogRecording& recording) {
  std::string badges;
  if (recording.is_reference_aided()) {
    badges += " <span class=\"badge\">reference-aided</span>";
  }
  if (recording.has_virtual_ticks) {
    badges += " <span class=\"badge\">virtual ticks</span>";
  }
  return badges;
}

std::string SummaryTable(std::span<const LogEvaluation> evaluations) {
  std::vector<std::vector<Cell>> rows{{{"recording", ""},
                                       {"path", ""},
                                       {"time", ""},
                                       {"raw", ""},
                                       {"batch", ""},
                                       {"online", ""},
                                       {"settled", ""},
                                       {"NEES in band", ""},
                                       {"raw aligned", ""},
                                       {"batch aligned", ""}}};
  for (const LogEvaluation& e : evaluations) {
    const EstimateEvaluation* settled = e.Find("settled");
    rows.push_back(
        {{e.name + (e.recording.is_reference_aided() ? " *" : ""), "name"},
         {fmt::format("{:.2f} m", e.path_m), ""},
         {fmt::format("{:.1f} s", e.truth_duration_s), ""},
         RmseCell(RawOf(e)),
         RmseCell(e.Find("dead_reckoning_batch")),
         RmseCell(e.Find("online")),
         RmseCell(settled),
         {settled != nullptr && settled->nees_position
              ? PercentText(settled->nees_position->share_inside)
              : "–",
          ""},
         AlignedCell(RawOf(e)),
         AlignedCell(e.Find("dead_reckoning_batch"))});
  }
  std::string text =
      "<h2>Summary</h2>\n<p>Root mean square distance between the estimated "
      "and the reference position. <b>raw</b>: dead "
      "reckoning with nominal wheel parameters. <b>batch</b>: the same wheel "
      "ticks with the parameters that the batch refiner found. <b>online</b>, "
      "<b>settled</b>: the filter's pose at once, and after its window for "
      "late measurements has closed. <b>aligned</b>: after the best rotation "
      "and shift, so that a wrong first heading does not count.</p>\n" +
      HtmlTable(rows);
  if (std::any_of(evaluations.begin(), evaluations.end(), [](const auto& e) {
        return e.recording.is_reference_aided();
      })) {
    text +=
        "<p class=\"small\">* reference-aided: the estimators were fed with "
        "thinned samples of the reference with stated noise; only the other "
        "samples are scored.</p>\n";
  }
  return text;
}

std::string RelativeText(const EstimateEvaluation& estimate, std::size_t i) {
  if (i >= estimate.relative.size()) return "–";
  const RelativeError& error = estimate.relative[i];
  if (error.translation.num == 0) return "–";
  std::string text = MetresText(error.translation.rmse);
  if (error.rotation.num > 0) {
    text += fmt::format(", {:.2f}°", DegreesFromRadians(error.rotation.rmse));
  }
  return text;
}

std::string NeesText(const std::optional<Nees>& nees) {
  return nees ? PercentText(nees->share_inside) : "–";
}

std::string EstimatesTable(const LogEvaluation& evaluation) {
  std::vector<std::vector<Cell>> rows{{{"estimate", ""},
                                       {"RMSE", ""},
                                       {"median", ""},
                                       {"max", ""},
                                       {"RMSE aligned", ""},
                                       {"heading RMSE", ""}}};
  for (const auto& estimate : evaluation.estimates) {
    if (estimate.relative.empty()) continue;
    for (const RelativeError& error : estimate.relative) {
      rows[0].push_back(
          {fmt::format("RPE, {:g} {}",
                       error.options.delta,
                       error.options.unit == DeltaUnit::kMetres ? "m" : "s"),
           ""});
    }
    break;
  }
  const std::size_t num_relative = rows[0].size() - 6;
  rows[0].push_back({"NEES in band", ""});
  rows[0].push_back({"of pose", ""});
  for (const auto& estimate : evaluation.estimates) {
    if (!estimate.aligned) continue;
    const auto& error = estimate.absolute;
    std::vector<Cell> row{{estimate.label, "name"}, RmseCell(&estimate)};
    row.push_back(
        {error ? MetresText(error->position_summary.median) : "–", ""});
    row.push_back({error ? MetresText(error->position_summary.max) : "–", ""});
    row.push_back({MetresText(estimate.aligned->position_summary.rmse), ""});
    row.push_back(
        {error && error->heading_summary.num > 0
             ? fmt::format("{:.2f}°",
                           DegreesFromRadians(error->heading_summary.rmse))
             : "–",
         ""});
    for (std::size_t i = 0; i < num_relative; ++i) {
      row.push_back({RelativeText(estimate, i), ""});
    }
    row.push_back({NeesText(estimate.nees_position), ""});
    row.push_back({NeesText(estimate.nees_pose), ""});
    rows.push_back(std::move(row));
  }
  return rows.size() > 1 ? HtmlTable(rows) : std::string();
}

std::string ParametersTable(const LogEvaluation& evaluation) {
  if (evaluation.parameters.empty()) return "";
  std::vector<std::vector<Cell>> rows{{{"source", ""},
                                       {"right wheel, µm per tick", ""},
                                       {"left wheel, µm per tick", ""},
                                       {"wheel base, mm", ""},
                                       {"observable", ""},
                                       {"estimates", ""}}};
  for (const auto& parameters : evaluation.parameters) {
    const ParameterConvergence& c = parameters.convergence;
    std::vector<Cell> row{{parameters.source, "name"}};
    const Eigen::Vector3d scale(1e6, 1e6, 1e3);
    for (int k = 0; k < 3; ++k) {
      row.push_back(
          {WithSigmaText(c.final.vector()(k) * scale(k), c.sigma(k) * scale(k)),
           ""});
    }
    row.push_back({ObservabilityText(c), ""});
    row.push_back({std::to_string(parameters.samples.size()), ""});
    rows.push_back(std::move(row));
  }
  return "<h3>Wheel parameters</h3>\n" + HtmlTable(rows) +
         "<p class=\"small\">± one sigma. Observable: how much of the variance "
         "before any measurement the measurements took away, of right wheel, "
         "left wheel and wheel base.</p>\n";
}

std::string ChannelsTable(const LogRecording& recording) {
  std::vector<std::vector<Cell>> rows{{{"channel", ""},
                                       {"messages", ""},
                                       {"rate", ""},
                                       {"longest gap", ""},
                                       {"lost", ""},
                                       {"unusable", ""},
                                       {"latency median", ""},
                                       {"p99", ""}}};
  for (const auto& [channel, health] : recording.channels) {
    const auto latency = recording.latency.find(channel);
    const bool has_latency = latency != recording.latency.end();
    rows.push_back(
        {{channel, "name"},
         {std::to_string(health.num_messages), ""},
         {health.rate_hz > 0 ? fmt::format("{:.2f} Hz", health.rate_hz) : "–",
          ""},
         {fmt::format("{:.2f} s", health.longest_gap_s), ""},
         {std::to_string(health.num_lost), health.num_lost > 0 ? "bad" : ""},
         {std::to_string(health.num_bad), health.num_bad > 0 ? "bad" : ""},
         {has_latency ? fmt::format("{:.2f} ms", latency->second.median_ms)
                      : "–",
          ""},
         {has_latency ? fmt::format("{:.2f} ms", latency->second.p99_ms) : "–",
          ""}});
  }
  const LogReadReport& file = recording.read_report;
  const char* latency =
      recording.latency.empty()
          ? "Latency is absent: the log was made offline."
          : "Latency: log time of the output minus that of its input.";
  return HtmlTable(rows) +
         fmt::format(
             "<p class=\"small\">Rates and gaps by the messages' own clock "
             "where their type is known. {} Log: {} events, {} bytes, {} "
             "skipped.</p>\n",
             latency,
             file.num_events,
             file.num_file_bytes,
             file.num_skipped_bytes);
}

std::string ProcessesTable(const LogRecording& recording) {
  if (recording.processes.empty()) return "";
  std::vector<std::vector<Cell>> rows{{{"process", ""},
                                       {"received", ""},
                                       {"published", ""},
                                       {"lost", ""},
                                       {"dropped", ""},
                                       {"bad", ""},
                                       {"worst handler", ""},
                                       {"faults", ""}}};
  for (const auto& [name, p] : recording.processes) {
    std::string faults;
    for (const ProcessFault& fault : p.faults)
      faults += FaultText(fault) + ". ";
    rows.push_back(
        {{name, "name"},
         {std::to_string(p.num_received), ""},
         {std::to_string(p.num_published), ""},
         {std::to_string(p.num_lost), p.num_lost > 0 ? "bad" : ""},
         {std::to_string(p.num_dropped), p.num_dropped > 0 ? "bad" : ""},
         {std::to_string(p.num_bad), p.num_bad > 0 ? "bad" : ""},
         {p.worst_handler_us
              ? fmt::format("{:.2f} ms",
                            static_cast<double>(*p.worst_handler_us) * 1e-3)
              : "–",
          ""},
         {faults.empty() ? "none" : faults, faults.empty() ? "" : "bad"}});
  }
  return HtmlTable(rows);
}

std::string HowMade(const LogEvaluation& evaluation) {
  std::string text = "<details><summary>How it was made</summary>\n<ul>\n";
  for (const auto& estimate : evaluation.estimates) {
    if (estimate.how.empty()) continue;
    text += "<li><b>" + EscapeHtml(estimate.label) +
            "</b>: " + EscapeHtml(estimate.how) + "</li>\n";
  }
  text += "<li><b>log</b>: " + EscapeHtml(evaluation.recording.path) +
          "</li>\n</ul>\n";
  for (const auto& [process, yaml] : evaluation.recording.configs) {
    text += "<h4>" + EscapeHtml(process) + "</h4>\n<pre>" + EscapeHtml(yaml) +
            "</pre>\n";
  }
  return text + "</details>\n";
}

std::string Section(const LogEvaluation& evaluation, std::size_t index) {
  const LogRecording& recording = evaluation.recording;
  std::string text = fmt::format("<section id=\"log{}\">\n<h2>", index) +
                     EscapeHtml(evaluation.name) + Badges(recording) +
                     "</h2>\n";
  if (!recording.truth.empty()) {
    text += fmt::format(
        "<p>Reference: {} samples, {:.2f} m in {:.1f} s ({}). {}.</p>\n",
        recording.truth.size(),
        evaluation.path_m,
        evaluation.truth_duration_s,
        EscapeHtml(recording.truth_source),
        EscapeHtml(FixesText(recording)));
  }
  if (!evaluation.notes.empty()) {
    text += "<ul class=\"notes\">\n";
    for (const std::string& note : evaluation.notes) {
      text += "<li>" + EscapeHtml(note) + "</li>\n";
    }
    text += "</ul>\n";
  }
  text += EstimatesTable(evaluation);
  text += "<div class=\"plots\">\n" + FigureOf(TrajectoryPlot(evaluation)) +
          FigureOf(PositionErrorPlot(evaluation));
  if (evaluation.has_truth_heading) {
    text += FigureOf(HeadingErrorPlot(evaluation));
  }
  text += FigureOf(NeesPlot(evaluation)) + "</div>\n";
  text += CorridorSection(evaluation) + PicturesOf(evaluation);
  text += ParametersTable(evaluation);
  if (!evaluation.parameters.empty()) {
    text += "<div class=\"plots three\">\n";
    for (const Plot& plot : ParameterPlots(evaluation)) text += FigureOf(plot);
    text += "</div>\n";
  }
  return text + "<h3>Health</h3>\n" + ChannelsTable(recording) +
         ProcessesTable(recording) + HowMade(evaluation) + "</section>\n";
}

constexpr const char* kDefinitions = R"(<section>
<h2>Definitions</h2>
<dl>
<dt>Association</dt><dd>A reference sample is compared with the estimate at its time, interpolated linearly between the two estimates around it; never extrapolated, never across gaps.</dd>
<dt>RMSE, median, max</dt><dd>Of the distance between the estimated and the reference position of the reference's point on the robot (absolute trajectory error). <i>Aligned</i>: after the best rotation and shift.</dd>
<dt>RPE</dt><dd>Relative pose error, root mean square: error of the motion over that length of reference path, or that time; every sample with the later one nearest to that length, within 10 %.</dd>
<dt>NEES</dt><dd>Error squared over the published covariance. The share of steps inside the two-sided 95 % band of its chi-square distribution; the mean of a consistent estimate is 2 for the position, 3 for the pose.</dd>
</dl>
</section>
)";

}  // namespace

ReportPicture LoadReportPicture(const std::string& path,
                                const std::string& caption) {
  constexpr std::size_t kMaxBytes = std::size_t{20} << 20;
  const std::string bytes = ReadWholeFile(path, kMaxBytes);
  std::string extension;
  if (bytes.starts_with("\x89PNG\r\n\x1a\n")) extension = ".png";
  if (bytes.starts_with("\xff\xd8\xff")) extension = ".jpg";
  if (extension.empty()) {
    throw InputError(path + ": is neither a PNG nor a JPEG");
  }
  return {caption, {extension, {bytes.begin(), bytes.end()}}};
}

std::string HtmlReport(std::span<const LogEvaluation> evaluations,
                       std::span<const ReportPicture> pictures) {
  std::string version;
  for (const LogEvaluation& evaluation : evaluations) {
    if (version.empty()) version = evaluation.recording.version;
  }
  std::string page =
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n"
      "<meta charset=\"utf-8\"/>\n"
      "<meta name=\"viewport\" content=\"width=device-width, "
      "initial-scale=1\"/>\n"
      "<meta name=\"color-scheme\" content=\"light dark\"/>\n"
      "<title>Waymark evaluation</title>\n<style>\n" +
      std::string(kReportStyle) + "</style>\n</head>\n<body>\n<header>\n";
  page += fmt::format(
      "<h1>Waymark evaluation</h1>\n<p>{} recording{}{}</p>\n",
      evaluations.size(),
      evaluations.size() == 1 ? "" : "s",
      version.empty() ? "" : ", made with version " + EscapeHtml(version));
  if (evaluations.size() > 1) {
    page += "<nav>";
    for (std::size_t i = 0; i < evaluations.size(); ++i) {
      page += fmt::format("<a href=\"#log{}\">", i) +
              EscapeHtml(evaluations[i].name) + "</a> ";
    }
    page += "</nav>\n";
  }
  page += "</header>\n<main>\n<section>\n" + SummaryTable(evaluations);
  if (!pictures.empty()) page += "<div class=\"plots wide\">\n";
  for (const ReportPicture& picture : pictures) {
    page += HtmlFigure(picture.caption, picture.file);
  }
  if (!pictures.empty()) page += "</div>\n";
  page += "</section>\n";
  for (std::size_t i = 0; i < evaluations.size(); ++i) {
    page += Section(evaluations[i], i);
  }
  return page + kDefinitions + "</main>\n</body>\n</html>\n";
}

}  // namespace waymark
