#include "logs/evaluation/evaluation_text.h"

#include <nlohmann/json.hpp>

namespace waymark {
namespace {

using nlohmann::json;

// Keys end in the unit: rmse_m, rmse_rad.
json JsonOf(const Summary& summary, const std::string& unit) {
  return {{"num", summary.num},
          {"rmse_" + unit, summary.rmse},
          {"mean_" + unit, summary.mean},
          {"median_" + unit, summary.median},
          {"p95_" + unit, summary.p95},
          {"max_" + unit, summary.max}};
}

json JsonOf(const std::optional<AbsoluteError>& error) {
  if (!error) return nullptr;
  json result{{"alignment", NameOf(error->alignment)},
              {"position", JsonOf(error->position_summary, "m")},
              {"heading", nullptr}};
  if (error->heading_summary.num > 0) {
    result["heading"] = JsonOf(error->heading_summary, "rad");
  }
  return result;
}

json JsonOf(const RelativeError& error) {
  json result{
      {"delta", error.options.delta},
      {"delta_unit", error.options.unit == DeltaUnit::kMetres ? "m" : "s"},
      {"relative_tolerance", error.options.relative_tolerance},
      {"compares", error.has_heading ? "poses" : "lengths"},
      {"translation", JsonOf(error.translation, "m")},
      {"rotation", nullptr}};
  if (error.rotation.num > 0) {
    result["rotation"] = JsonOf(error.rotation, "rad");
  }
  return result;
}

json JsonOf(const std::optional<Nees>& nees) {
  if (!nees) return nullptr;
  return {{"dof", nees->dof},
          {"num", nees->values.size()},
          {"mean", nees->mean},
          {"band_95", {nees->band.low, nees->band.high}},
          {"share_inside", nees->share_inside},
          {"share_below", nees->share_below},
          {"share_above", nees->share_above},
          {"num_unusable", nees->num_unusable}};
}

json JsonOf(const EstimateEvaluation& estimate) {
  json result{{"id", estimate.id},
              {"label", estimate.label},
              {"how", estimate.how},
              {"missing", estimate.missing},
              {"num_poses", estimate.path.size()},
              {"num_pairs", estimate.num_pairs},
              {"num_outside", estimate.num_outside},
              {"num_in_gaps", estimate.num_in_gaps},
              {"ate", JsonOf(estimate.absolute)},
              {"ate_aligned", JsonOf(estimate.aligned)},
              {"nees_position", JsonOf(estimate.nees_position)},
              {"nees_pose", JsonOf(estimate.nees_pose)},
              {"rpe", json::array()}};
  for (const RelativeError& error : estimate.relative) {
    result["rpe"].push_back(JsonOf(error));
  }
  return result;
}

json JsonOf(const LatencySummary& l) {
  return {{"num", l.num},
          {"median_ms", l.median_ms},
          {"p95_ms", l.p95_ms},
          {"p99_ms", l.p99_ms},
          {"max_ms", l.max_ms}};
}

json JsonOf(const std::optional<SightHealth>& sight) {
  if (!sight) return nullptr;
  json result{{"channel", sight->channel},
              {"num_images", sight->num_images},
              {"num_unanswered", sight->num_unanswered},
              {"num_lost", sight->num_lost},
              {"to_answer", nullptr},
              {"to_pose", nullptr}};
  if (sight->to_answer) result["to_answer"] = JsonOf(*sight->to_answer);
  if (sight->to_pose) result["to_pose"] = JsonOf(*sight->to_pose);
  return result;
}

json JsonOf(const CorridorErrorSummary& errors) {
  return {{"y", JsonOf(errors.y_m, "m")},
          {"heading", JsonOf(errors.heading_rad, "rad")},
          {"worst_y_sigmas", errors.worst_y_sigmas},
          {"worst_heading_sigmas", errors.worst_heading_sigmas}};
}

json JsonOf(const std::optional<CorridorEvaluation>& corridor) {
  if (!corridor) return nullptr;
  return {{"num", corridor->num},
          {"statuses", corridor->statuses},
          {"accepted_share", corridor->accepted_share()},
          {"lines", JsonOf(corridor->lines_ms, "ms")},
          {"pose", JsonOf(corridor->pose_ms, "ms")},
          {"seen", JsonOf(corridor->seen)},
          {"fused", JsonOf(corridor->fused)}};
}

json ParametersJson(const Eigen::Vector3d& v) {
  return {{"k_right", v(0)}, {"k_left", v(1)}, {"wheel_base", v(2)}};
}

json JsonOf(const ParameterEvaluation& parameters,
            const std::string& reference) {
  const ParameterConvergence& c = parameters.convergence;
  json result{{"source", parameters.source},
              {"num", parameters.samples.size()},
              {"final", ParametersJson(c.final.vector())},
              {"sigma", ParametersJson(c.sigma)},
              {"observability", ParametersJson(c.observability)},
              {"reference", nullptr}};
  if (c.has_reference) {
    result["reference"] = reference;
    result["relative_error"] = ParametersJson(c.relative_error);
    result["normalised_error"] = ParametersJson(c.normalised_error);
    json settled;
    const char* names[] = {"k_right", "k_left", "wheel_base"};
    for (std::size_t k = 0; k < 3; ++k) {
      settled[names[k]] =
          c.settled_s[k] ? json(*c.settled_s[k]) : json(nullptr);
    }
    result["within_1_percent_after_s"] = settled;
  }
  return result;
}

json FaultsJson(const ProcessHealth& process) {
  json faults = json::array();
  for (const ProcessFault& fault : process.faults) {
    faults.push_back(
        {{"text", fault.text}, {"num", fault.num}, {"first_s", fault.first_s}});
  }
  return faults;
}

json HealthJson(const LogRecording& recording) {
  json channels = json::object();
  for (const auto& [name, c] : recording.channels) {
    channels[name] = {{"num_messages", c.num_messages},
                      {"num_bad", c.num_bad},
                      {"num_lost", c.num_lost},
                      {"rate_hz", c.rate_hz},
                      {"longest_gap_s", c.longest_gap_s}};
  }
  json latency = json::object();
  for (const auto& [name, l] : recording.latency) {
    latency[name] = JsonOf(l);
  }
  json processes = json::object();
  for (const auto& [name, p] : recording.processes) {
    processes[name] = {
        {"num_received", p.num_received},
        {"num_published", p.num_published},
        {"num_lost", p.num_lost},
        {"num_dropped", p.num_dropped},
        {"num_bad", p.num_bad},
        {"worst_handler_us",
         p.worst_handler_us ? json(*p.worst_handler_us) : json(nullptr)},
        {"faults", FaultsJson(p)}};
  }
  return {{"channels", channels},
          {"latency", recording.latency.empty() ? json(nullptr) : latency},
          {"sight", JsonOf(recording.sight)},
          {"processes", processes}};
}

}  // namespace

json JsonOf(const LogEvaluation& evaluation) {
  const LogRecording& recording = evaluation.recording;
  json result{{"schema", "waymark-evaluation-1"},
              {"log", recording.path},
              {"name", evaluation.name},
              {"reference_aided", recording.is_reference_aided()},
              {"virtual_ticks", recording.has_virtual_ticks},
              {"reference",
               {{"source", recording.truth_source},
                {"num", recording.truth.size()},
                {"has_heading", evaluation.has_truth_heading},
                {"duration_s", evaluation.truth_duration_s},
                {"path_m", evaluation.path_m}}},
              {"num_fixes", recording.fixes.size()},
              {"log_file",
               {{"num_events", recording.read_report.num_events},
                {"num_bytes", recording.read_report.num_file_bytes},
                {"num_skipped_bytes", recording.read_report.num_skipped_bytes},
                {"num_gaps", recording.read_report.num_gaps}}},
              {"estimates", json::array()},
              {"corridor", JsonOf(evaluation.corridor)},
              {"parameters", json::array()},
              {"health", HealthJson(recording)},
              {"version", recording.version},
              {"notes", evaluation.notes}};
  for (const EstimateEvaluation& estimate : evaluation.estimates) {
    result["estimates"].push_back(JsonOf(estimate));
  }
  for (const ParameterEvaluation& parameters : evaluation.parameters) {
    result["parameters"].push_back(
        JsonOf(parameters, evaluation.parameter_reference));
  }
  return result;
}

}  // namespace waymark
