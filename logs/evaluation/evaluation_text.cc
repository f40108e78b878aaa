#include "logs/evaluation/evaluation_text.h"

#include "estimation/geometry/angle.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

namespace waymark {
namespace {

std::string RmseOf(const std::optional<AbsoluteError>& error) {
  return error ? MetresText(error->position_summary.rmse) : "-";
}

std::string DeltaText(const RelativeErrorOptions& options) {
  return fmt::format(
      "{:g} {}", options.delta, options.unit == DeltaUnit::kMetres ? "m" : "s");
}

void AppendEstimates(const LogEvaluation& evaluation, std::string* text) {
  const auto line = [&](const auto&... cells) {
    *text += fmt::format("  {:<25}{:>9}{:>9}{:>9}{:>10}{:>9}{:>9}{:>11}\n",
                         cells...);
  };
  std::string delta = "RPE";
  for (const auto& estimate : evaluation.estimates) {
    if (estimate.relative.empty()) continue;
    delta = "RPE/" + DeltaText(estimate.relative[0].options);
    break;
  }
  line("estimate",
       "ATE rmse",
       "median",
       "max",
       "SE(2) rms",
       "heading",
       delta,
       "NEES in");
  for (const auto& estimate : evaluation.estimates) {
    if (!estimate.missing.empty() || estimate.num_pairs == 0) {
      *text += fmt::format("  {:<25}-  {}\n",
                           estimate.label,
                           estimate.missing.empty() ? "no reference to compare"
                                                    : estimate.missing);
      continue;
    }
    const auto& error = estimate.absolute;
    const bool has_heading = error && error->heading_summary.num > 0;
    const bool has_relative =
        !estimate.relative.empty() && estimate.relative[0].translation.num > 0;
    line(estimate.label,
         RmseOf(error),
         error ? MetresText(error->position_summary.median) : "-",
         error ? MetresText(error->position_summary.max) : "-",
         RmseOf(estimate.aligned),
         has_heading
             ? fmt::format("{:.2f}°",
                           DegreesFromRadians(error->heading_summary.rmse))
             : "-",
         has_relative ? MetresText(estimate.relative[0].translation.rmse) : "-",
         estimate.nees_position
             ? PercentText(estimate.nees_position->share_inside)
             : "-");
  }
}

void AppendParameters(const LogEvaluation& evaluation, std::string* text) {
  if (evaluation.parameters.empty()) return;
  *text += fmt::format("  {:<12}{:>23}{:>23}{:>23}{:>17}\n",
                       "parameters",
                       "k_right, um/tick",
                       "k_left, um/tick",
                       "wheel base, mm",
                       "observable");
  for (const ParameterEvaluation& p : evaluation.parameters) {
    *text += fmt::format("  {:<12}", p.source);
    const Eigen::Vector3d value = p.convergence.final.vector();
    const Eigen::Vector3d scale(1e6, 1e6, 1e3);
    for (int k = 0; k < 3; ++k) {
      *text += fmt::format("{:>23}",
                           WithSigmaText(value(k) * scale(k),
                                         p.convergence.sigma(k) * scale(k)));
    }
    *text += fmt::format("{:>17}\n", ObservabilityText(p.convergence));
  }
}

void AppendCorridor(const LogEvaluation& evaluation, std::string* text) {
  if (!evaluation.corridor) return;
  const CorridorEvaluation& corridor = *evaluation.corridor;
  *text += fmt::format(
      "  corridor: {} of {} images accepted ({})",
      static_cast<int>(std::lround(corridor.accepted_share() * corridor.num)),
      corridor.num,
      PercentText(corridor.accepted_share()));
  for (const auto& [status, num] : corridor.statuses) {
    if (status != NameOf(CorridorStatus::kAccepted)) {
      *text += fmt::format(", {} {}", num, status);
    }
  }
  *text += "\n";
  if (corridor.lines_ms.num > 0) {
    *text += fmt::format(
        "  time of corridor_tracker: lines median {:.2f} ms, p95 {:.2f} ms; "
        "pose from them median {:.2f} ms, p95 {:.2f} ms\n",
        corridor.lines_ms.median,
        corridor.lines_ms.p95,
        corridor.pose_ms.median,
        corridor.pose_ms.p95);
  }
  for (const auto& [name, errors] : {std::pair("seen", &corridor.seen),
                                     std::pair("POSE", &corridor.fused)}) {
    if (errors->y_m.num == 0) continue;
    *text += fmt::format(
        "  across it, {}: rmse {}, median {}, p95 {}, max {} ({:.1f} sigma); "
        "heading rmse {:.2f}°, p95 {:.2f}°, max {:.2f}° ({:.1f} sigma)\n",
        name,
        MetresText(errors->y_m.rmse),
        MetresText(errors->y_m.median),
        MetresText(errors->y_m.p95),
        MetresText(errors->y_m.max),
        errors->worst_y_sigmas,
        DegreesFromRadians(errors->heading_rad.rmse),
        DegreesFromRadians(errors->heading_rad.p95),
        DegreesFromRadians(errors->heading_rad.max),
        errors->worst_heading_sigmas);
  }
}

void AppendSight(const LogRecording& recording, std::string* text) {
  if (!recording.sight) return;
  const SightHealth& sight = *recording.sight;
  *text += fmt::format("  {}: {} images, {} lost, {} unanswered\n",
                       sight.channel,
                       sight.num_images,
                       sight.num_lost,
                       sight.num_unanswered);
  for (const auto& [what, latency] :
       {std::pair("CORRIDOR_POSE", &sight.to_answer),
        std::pair("the POSE behind it", &sight.to_pose)}) {
    if (!*latency) continue;
    *text += fmt::format(
        "  from exposure to {}: median {:.2f} ms, p95 {:.2f} ms, p99 {:.2f} "
        "ms, max {:.2f} ms\n",
        what,
        (*latency)->median_ms,
        (*latency)->p95_ms,
        (*latency)->p99_ms,
        (*latency)->max_ms);
  }
}

void AppendHealth(const LogRecording& recording, std::string* text) {
  for (const auto& [channel, latency] : recording.latency) {
    *text += fmt::format(
        "  latency of {}: median {:.2f} ms, p95 {:.2f} ms, p99 {:.2f} ms, max "
        "{:.2f} ms\n",
        channel,
        latency.median_ms,
        latency.p95_ms,
        latency.p99_ms,
        latency.max_ms);
  }
  for (const auto& [name, process] : recording.processes) {
    *text += fmt::format(
        "  {}: {} received, {} published, {} lost, {} dropped, {} bad\n",
        name,
        process.num_received,
        process.num_published,
        process.num_lost,
        process.num_dropped,
        process.num_bad);
    for (const ProcessFault& fault : process.faults) {
      *text += fmt::format("  {}: fault: {}\n", name, FaultText(fault));
    }
  }
  for (const auto& [channel, health] : recording.channels) {
    if (health.num_lost == 0 && health.num_bad == 0) continue;
    *text += fmt::format("  {}: {} lost (sequence gaps), {} unusable\n",
                         channel,
                         health.num_lost,
                         health.num_bad);
  }
}

}  // namespace

std::string ObservabilityText(const ParameterConvergence& convergence) {
  const Eigen::Vector3d percent = 100.0 * convergence.observability;
  if (percent.isZero(0.0)) return "-";
  return fmt::format(
      "{:.0f} {:.0f} {:.0f} %", percent(0), percent(1), percent(2));
}

std::string FaultText(const ProcessFault& fault) {
  if (fault.num == 1) {
    return fmt::format("{} (once, at {:.1f} s)", fault.text, fault.first_s);
  }
  return fmt::format(
      "{} ({} times, from {:.1f} s on)", fault.text, fault.num, fault.first_s);
}

std::string WithSigmaText(double value, double sigma) {
  if (!(sigma > 0.0) || !std::isfinite(sigma)) {
    return fmt::format("{:.4f}", value);
  }
  const int decimals =
      std::clamp(1 - static_cast<int>(std::floor(std::log10(sigma))), 0, 6);
  return fmt::format("{:.{}f} ± {:.{}f}", value, decimals, sigma, decimals);
}

std::string PercentText(double share) {
  return fmt::format("{:.1f} %", 100.0 * share);
}

std::string MetresText(double metres) {
  if (!std::isfinite(metres)) return "-";
  if (metres >= 1.0) return fmt::format("{:.3f} m", metres);
  return fmt::format("{:.{}f} mm", metres * 1e3, metres < 0.1 ? 2 : 1);
}

std::string FixesText(const LogRecording& recording) {
  struct Source {
    int num = 0;
    double sigma_m = 0.0;
  };
  std::map<std::string, Source> sources;
  for (const AbsoluteFix& fix : recording.fixes) {
    Source& source = sources[fix.source];
    const int k = fix.has[0] ? 0 : 1;
    if (source.num == 0 && fix.has[static_cast<std::size_t>(k)]) {
      source.sigma_m = std::sqrt(fix.covariance(k, k));
    }
    ++source.num;
  }
  std::string text;
  for (const auto& [name, source] : sources) {
    text += fmt::format(
        "{}{} fixes from '{}'{}",
        text.empty() ? "" : "; ",
        source.num,
        name,
        source.sigma_m > 0.0 ? ", sigma " + MetresText(source.sigma_m) : "");
  }
  return text.empty() ? "no position fixes" : text;
}

std::string TableOf(const LogEvaluation& evaluation) {
  const LogRecording& recording = evaluation.recording;
  std::string text =
      fmt::format("{}{}\n",
                  recording.path,
                  recording.is_reference_aided() ? "  [reference-aided]" : "");
  if (!recording.truth.empty()) {
    text += fmt::format("  reference: {} samples, {:.2f} m in {:.1f} s ({})\n",
                        recording.truth.size(),
                        evaluation.path_m,
                        evaluation.truth_duration_s,
                        recording.truth_source);
  }
  text += "  " + FixesText(recording) + "\n";
  AppendEstimates(evaluation, &text);
  AppendCorridor(evaluation, &text);
  AppendParameters(evaluation, &text);
  AppendSight(recording, &text);
  AppendHealth(recording, &text);
  for (const std::string& note : evaluation.notes) {
    text += "  note: " + note + "\n";
  }
  return text;
}

namespace {

std::string MillisecondsText(const std::optional<LatencySummary>& latency) {
  return latency ? fmt::format("{:.1f} ms", latency->p95_ms) : "-";
}

// Of recordings that have any; lateral position and heading of POSE.
std::string CorridorTableOf(std::span<const LogEvaluation> evaluations) {
  const auto line = [](const auto&... cells) {
    return fmt::format(
        "{:<22}{:>8}{:>10}{:>11}{:>10}{:>9}{:>8}{:>12}{:>10}{:>6}\n", cells...);
  };
  std::string text;
  for (const LogEvaluation& evaluation : evaluations) {
    if (!evaluation.corridor) continue;
    const CorridorErrorSummary& fused = evaluation.corridor->fused;
    const SightHealth sight =
        evaluation.recording.sight.value_or(SightHealth{});
    const auto metres = [&](double m) {
      return fused.y_m.num > 0 ? MetresText(m) : std::string("-");
    };
    const auto degrees = [&](double rad) {
      return fused.heading_rad.num > 0
                 ? fmt::format("{:.2f}°", DegreesFromRadians(rad))
                 : std::string("-");
    };
    text += line(evaluation.name,
                 evaluation.corridor->num,
                 PercentText(evaluation.corridor->accepted_share()),
                 metres(fused.y_m.rmse),
                 metres(fused.y_m.max),
                 degrees(fused.heading_rad.rmse),
                 degrees(fused.heading_rad.max),
                 MillisecondsText(sight.to_answer),
                 MillisecondsText(sight.to_pose),
                 sight.num_lost + sight.num_unanswered);
  }
  if (text.empty()) return "";
  return line("Across the corridor",
              "images",
              "accepted",
              "off, rmse",
              "max",
              "heading",
              "max",
              "answer p95",
              "POSE p95",
              "lost") +
         text +
         "off, heading: of POSE. p95: from an image's exposure to its "
         "CORRIDOR_POSE, and to the next POSE. lost: images not sent, not "
         "recorded or not answered.\n";
}

}  // namespace

std::string SummaryTableOf(std::span<const LogEvaluation> evaluations) {
  const auto line = [](const auto&... cells) {
    return fmt::format("{:<22}{:>8}{:>10}{:>10}{:>10}{:>10}{:>8}{:>11}{:>12}\n",
                       cells...);
  };
  std::string text = line("RMSE of position",
                          "path",
                          "raw",
                          "batch",
                          "online",
                          "settled",
                          "NEES in",
                          "raw SE(2)",
                          "batch SE(2)");
  bool is_any_aided = false;
  for (const LogEvaluation& evaluation : evaluations) {
    const auto rmse = [&](std::string_view id) {
      const EstimateEvaluation* estimate = evaluation.Find(id);
      return estimate == nullptr ? std::string("-")
                                 : RmseOf(estimate->absolute);
    };
    const EstimateEvaluation* settled = evaluation.Find("settled");
    const bool is_aided = evaluation.recording.is_reference_aided();
    is_any_aided |= is_aided;
    const auto aligned = [&](std::string_view id) {
      const EstimateEvaluation* estimate = evaluation.Find(id);
      return estimate == nullptr ? std::string("-") : RmseOf(estimate->aligned);
    };
    const std::string_view raw = rmse("raw") == "-" ? "raw_nominal" : "raw";
    text += line(evaluation.name + (is_aided ? " *" : ""),
                 fmt::format("{:.2f} m", evaluation.path_m),
                 rmse(raw),
                 rmse("dead_reckoning_batch"),
                 rmse("online"),
                 rmse("settled"),
                 settled != nullptr && settled->nees_position
                     ? PercentText(settled->nees_position->share_inside)
                     : "-",
                 aligned(raw),
                 aligned("dead_reckoning_batch"));
  }
  text +=
      "raw, batch: dead reckoning with nominal and with batch parameters; "
      "online, settled: POSE, POSE_SETTLED.\n"
      "SE(2): after the best rotation and shift, so that a wrong first heading "
      "does not count.\n";
  if (is_any_aided) {
    text +=
        "* reference-aided: fed with thinned, noisy samples of the reference, "
        "scored on the others\n";
  }
  return text + CorridorTableOf(evaluations);
}

}  // namespace waymark
