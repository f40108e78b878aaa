#include "logs/evaluation/log_evaluation.h"

#include "logs/evaluation/simulated_wheels.h"
#include "processes/support/channels.h"

#include <algorithm>
#include <filesystem>

namespace waymark {
namespace {

// Where dead reckoning is tied to the world.
struct AnchorPoint {
  Time time;
  Pose2 X_WR;
  std::string how;
};

const std::vector<EstimatedPose>* PathOn(const LogRecording& recording,
                                         std::string_view channel) {
  const auto found = recording.poses.find(std::string(channel));
  return found == recording.poses.end() || found->second.empty()
             ? nullptr
             : &found->second;
}

std::optional<AnchorPoint> FindAnchor(const LogRecording& recording) {
  if (const auto& start = recording.initial_pose) {
    return AnchorPoint{start->time, start->X_WR, "anchored at INITIAL_POSE"};
  }
  for (const TruthSample& sample : recording.truth) {
    if (!sample.heading) continue;
    Pose2 X_WR{0.0, 0.0, *sample.heading};
    const Eigen::Vector2d p_WR = sample.p_WS - X_WR * sample.p_RS;
    X_WR.x = p_WR.x();
    X_WR.y = p_WR.y();
    return AnchorPoint{
        sample.time, X_WR, "anchored at the first reference sample"};
  }
  for (const auto channel : {kPoseSettled, kPose}) {
    if (const auto* path = PathOn(recording, channel)) {
      return AnchorPoint{path->front().time,
                         path->front().X_WR,
                         "anchored at the first known " + std::string(channel)};
    }
  }
  return std::nullopt;
}

EstimateEvaluation Named(std::string id, std::string label) {
  EstimateEvaluation estimate;
  estimate.id = std::move(id);
  estimate.label = std::move(label);
  return estimate;
}

void Score(const LogRecording& recording,
           const EvaluationOptions& options,
           bool is_in_world,
           EstimateEvaluation* estimate) {
  const Association association =
      Associate(recording.truth, estimate->path, options.association);
  estimate->num_pairs = static_cast<int>(association.pairs.size());
  estimate->num_outside = association.num_outside;
  estimate->num_in_gaps = association.num_in_gaps;
  if (is_in_world) {
    estimate->absolute =
        EvaluateAbsoluteError(association.pairs, Alignment::kNone);
  }
  estimate->aligned = EvaluateAbsoluteError(association.pairs, Alignment::kSe2);
  for (const RelativeErrorOptions& relative : options.relative_errors) {
    estimate->relative.push_back(
        EvaluateRelativeError(association.pairs, relative));
  }
  if (is_in_world) {
    estimate->nees_position = EvaluateNees(association.pairs, 2);
    estimate->nees_pose = EvaluateNees(association.pairs, 3);
  }
}

class Evaluator {
 public:
  Evaluator(const LogRecording& recording, const EvaluationOptions& options)
      : recording_(recording),
        options_(options),
        anchor_(FindAnchor(recording)) {}

  // Dead reckoning as published.
  EstimateEvaluation Raw() const {
    EstimateEvaluation estimate = Named("raw", "raw (ODOMETRY)");
    const auto* path = PathOn(recording_, kOdometry);
    if (path == nullptr) {
      estimate.missing = "no ODOMETRY in the log";
      return estimate;
    }
    std::vector<EstimatedPose> bare = *path;
    // Its covariance is of X_OR: without the start's it says nothing about W.
    for (EstimatedPose& pose : bare) pose.covariance.reset();
    Finish("ODOMETRY as published", std::move(bare), &estimate);
    return estimate;
  }

  EstimateEvaluation Published(std::string id,
                               std::string label,
                               std::string_view channel) const {
    EstimateEvaluation estimate = Named(std::move(id), std::move(label));
    const auto* path = PathOn(recording_, channel);
    if (path == nullptr) {
      estimate.missing = "no known pose on " + std::string(channel);
      return estimate;
    }
    estimate.how = std::string(channel) + " as published";
    estimate.path = *path;
    Score(recording_, options_, true, &estimate);
    return estimate;
  }

  // Offline, over the recorded ticks, with the newest parameters of `source`.
  EstimateEvaluation Reckoned(std::string id,
                              std::string label,
                              const std::string& source) const {
    EstimateEvaluation estimate = Named(std::move(id), std::move(label));
    const auto found = recording_.parameters.find(source);
    if (recording_.readings.empty()) {
      estimate.missing = "no ENCODERS in the log";
    } else if (found == recording_.parameters.end()) {
      const auto why = recording_.parameters_missing.find(source);
      estimate.missing =
          "no ODOMETRY_PARAMETERS of source '" + source + "'" +
          (why == recording_.parameters_missing.end() ? ""
                                                      : ": " + why->second);
    } else {
      Finish("ENCODERS integrated offline with the final " + source +
                 " parameters",
             DeadReckon(recording_.readings, found->second.back().parameters),
             &estimate);
    }
    return estimate;
  }

 private:
  void Finish(const std::string& how,
              std::vector<EstimatedPose> path,
              EstimateEvaluation* estimate) const {
    estimate->how =
        how + ", " +
        (anchor_ ? anchor_->how : std::string("not anchored: no start known"));
    estimate->path = anchor_
                         ? Anchor(std::move(path), anchor_->time, anchor_->X_WR)
                         : std::move(path);
    Score(recording_, options_, anchor_.has_value(), estimate);
  }

  const LogRecording& recording_;
  const EvaluationOptions& options_;
  std::optional<AnchorPoint> anchor_;
};

void EvaluateParameters(const EvaluationOptions& options,
                        LogEvaluation* evaluation) {
  const auto& parameters = evaluation->recording.parameters;
  std::optional<WheelParameters> truth;
  const auto simulator = evaluation->recording.configs.find("simulator");
  if (simulator != evaluation->recording.configs.end()) {
    truth = SimulatedWheels(simulator->second);
  }
  std::optional<WheelParameters> reference = options.known_parameters;
  if (reference) {
    evaluation->parameter_reference = "known";
  } else if (truth) {
    reference = truth;
    evaluation->parameter_reference = "truth";
  } else if (const auto batch = parameters.find("batch");
             batch != parameters.end()) {
    reference = batch->second.back().parameters;
    evaluation->parameter_reference = "batch";
  }
  for (const auto* source : {"nominal", "online", "batch"}) {
    const auto found = parameters.find(source);
    if (found == parameters.end()) continue;
    evaluation->parameters.push_back(
        {source, found->second, EvaluateConvergence(found->second, reference)});
  }
  if (!truth || evaluation->parameters.empty()) return;
  std::vector<ParameterSample> samples(1);
  samples[0].time = evaluation->parameters[0].samples[0].time;
  samples[0].parameters = *truth;
  evaluation->parameters.push_back(
      {"truth", samples, EvaluateConvergence(samples, {})});
}

void AddNotes(LogEvaluation* evaluation) {
  const LogRecording& recording = evaluation->recording;
  auto& notes = evaluation->notes;
  if (recording.truth.empty()) {
    notes.emplace_back("No TRUTH in the log: no path can be scored.");
  } else if (!evaluation->has_truth_heading) {
    notes.emplace_back(
        "The reference has no headings: no heading error, no pose NEES, and "
        "relative errors compare lengths only.");
  }
  if (recording.is_reference_aided()) {
    notes.emplace_back(
        "Reference-aided: POSITION_FIX holds thinned samples of the reference "
        "with stated noise; TRUTH holds only the others.");
  }
  if (recording.has_virtual_ticks) {
    notes.emplace_back(
        "Ticks are virtual: made from recorded wheel velocities.");
  }
  if (recording.read_report.num_gaps > 0) {
    notes.push_back("The log is damaged: " +
                    recording.read_report.SkippedText() + " skipped.");
  }
  std::string lost;
  for (const auto& [channel, health] : recording.channels) {
    if (health.num_lost == 0) continue;
    const std::int64_t num_sent =
        health.num_lost + health.num_messages - health.num_bad;
    lost += (lost.empty() ? "" : ", ") + std::to_string(health.num_lost) +
            " of " + std::to_string(num_sent) + " on " + channel;
  }
  if (!lost.empty()) {
    notes.push_back(
        "Messages that were numbered are not in the log: " + lost +
        ". A recorder that fell behind (a busy machine, a high --speed) leaves "
        "out what the processes themselves may have got.");
  }
  for (const EstimateEvaluation& estimate : evaluation->estimates) {
    if (!estimate.missing.empty()) {
      notes.push_back(estimate.label + ": " + estimate.missing + ".");
    } else if (!recording.truth.empty() && estimate.num_pairs == 0) {
      notes.push_back(estimate.label +
                      ": no reference sample lies within its times.");
    }
  }
}

}  // namespace

const EstimateEvaluation* LogEvaluation::Find(std::string_view id) const {
  const auto found = std::find_if(estimates.begin(),
                                  estimates.end(),
                                  [&](const auto& e) { return e.id == id; });
  return found == estimates.end() ? nullptr : &*found;
}

LogEvaluation EvaluateRecording(LogRecording recording,
                                const EvaluationOptions& options) {
  LogEvaluation evaluation;
  evaluation.name = std::filesystem::path(recording.path).stem().string();
  evaluation.recording = std::move(recording);
  const LogRecording& r = evaluation.recording;
  if (!r.truth.empty()) {
    const auto [first, last] = std::minmax_element(
        r.truth.begin(), r.truth.end(), [](const auto& a, const auto& b) {
          return a.time < b.time;
        });
    evaluation.truth_duration_s = Seconds(last->time - first->time);
    std::vector<AssociatedPair> pairs;
    for (const TruthSample& sample : r.truth) {
      pairs.push_back({sample, {}});
      evaluation.has_truth_heading |= sample.heading.has_value();
    }
    evaluation.path_m = PathLength(pairs);
  }
  const Evaluator evaluator(r, options);
  evaluation.estimates = {
      evaluator.Raw(),
      evaluator.Reckoned("raw_nominal", "dead reckoning, nominal", "nominal"),
      evaluator.Published("online", "online (POSE)", kPose),
      evaluator.Published("settled", "online (POSE_SETTLED)", kPoseSettled),
      evaluator.Reckoned(
          "dead_reckoning_online", "dead reckoning, online", "online"),
      evaluator.Reckoned(
          "dead_reckoning_batch", "dead reckoning, batch", "batch")};
  const auto* pose = PathOn(evaluation.recording, kPose);
  evaluation.corridor = EvaluateCorridor(
      evaluation.recording.corridor,
      evaluation.recording.truth,
      pose == nullptr ? std::span<const EstimatedPose>() : std::span(*pose),
      options.association);
  EvaluateParameters(options, &evaluation);
  AddNotes(&evaluation);
  return evaluation;
}

}  // namespace waymark
