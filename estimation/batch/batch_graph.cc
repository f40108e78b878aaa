#include "estimation/batch/batch_graph.h"

#include "estimation/base/check.h"
#include "estimation/batch/batch_costs.h"
#include "estimation/batch/trajectory_guess.h"
#include "estimation/geometry/angle.h"

#include <algorithm>
#include <cmath>

namespace waymark {
namespace {

// The gauge prior: far wider than what is known of any log's start, so that it
// only holds what nothing else does (a path without absolute fixes may lie
// anywhere; the parameters do not depend on where).
constexpr double kGaugeSigmaM = 10.0;
constexpr double kGaugeSigmaRad = 10.0;

// Floor of a step's covariance where tick_sigma is 0 and nothing moves.
constexpr double kFloorM = 1e-6;
constexpr double kFloorRad = 1e-6;

// Times at which a log needs keyframes, ascending, at the offsets of `sensors`.
std::vector<double> KeyframeTimes(
    const BatchLogInput& log,
    const std::vector<std::array<double, 4>>& sensors,
    double keyframe_s) {
  std::vector<double> times;
  const auto add = [&](double time, int sensor) {
    times.push_back(
        std::clamp(time - sensors[static_cast<std::size_t>(sensor)][3],
                   0.0,
                   log.track.duration()));
  };
  for (const BatchFixInput& fix : log.fixes) add(fix.time, fix.sensor);
  for (const BatchMotionInput& motion : log.motions) {
    add(motion.from, motion.sensor);
    add(motion.time, motion.sensor);
  }
  if (log.start) times.push_back(log.track.SecondsAt(log.start->time));
  std::sort(times.begin(), times.end());
  std::vector<double> keyframes;
  for (const double time : times) {
    if (keyframes.empty() || time > keyframes.back() + keyframe_s) {
      keyframes.push_back(time);
    }
  }
  return keyframes;
}

Eigen::Matrix3d StepCovariance(const TickTrack& track,
                               double t0,
                               double t1,
                               const WheelParameters& wheels,
                               const BatchOptions& options) {
  const TrackMotion step =
      track.Integrate(t0, t1, wheels, options.noise, options.integration);
  // Both readings are off by tick_sigma, each wheel on its own; taken as a
  // motion at the end of the step.
  const double c = std::cos(step.X_R0R1.heading);
  const double s = std::sin(step.X_R0R1.heading);
  Eigen::Matrix<double, 3, 2> by_travel;
  by_travel << 0.5 * c, 0.5 * c, 0.5 * s, 0.5 * s, 1.0 / wheels.wheel_base,
      -1.0 / wheels.wheel_base;
  const double sigma = std::sqrt(2.0) * options.tick_sigma;
  const Eigen::Vector2d variances(std::pow(sigma * wheels.k_right, 2),
                                  std::pow(sigma * wheels.k_left, 2));
  Eigen::Matrix3d covariance = step.covariance + by_travel *
                                                     variances.asDiagonal() *
                                                     by_travel.transpose();
  const Eigen::Vector3d sideways(-s, c, 0.0);
  covariance +=
      std::pow(options.slip_sigma_m, 2) * sideways * sideways.transpose();
  covariance.diagonal() += Eigen::Vector3d(
      kFloorM * kFloorM, kFloorM * kFloorM, kFloorRad * kFloorRad);
  return covariance;
}

std::unique_ptr<ceres::LossFunction> MakeLoss(BatchLoss loss, double scale) {
  switch (loss) {
    case BatchLoss::kNone:
      return nullptr;
    case BatchLoss::kHuber:
      return std::make_unique<ceres::HuberLoss>(scale);
    case BatchLoss::kCauchy:
      return std::make_unique<ceres::CauchyLoss>(scale);
  }
  return nullptr;
}

class Builder {
 public:
  Builder(const BatchInput& input,
          const BatchOptions& options,
          BatchLoss loss,
          BatchState* state)
      : input_(input),
        options_(options),
        loss_(loss),
        scale_(options.loss_scale),
        state_(state) {}

  std::vector<BatchFactor> Build() {
    AddGlobalPriors();
    for (std::size_t i = 0; i < input_.logs.size(); ++i) {
      if (!state_->logs[i].empty()) AddLog(static_cast<int>(i));
    }
    return std::move(factors_);
  }

 private:
  void AddGlobalPriors() {
    const Eigen::Matrix3d wheels =
        options_.relative_sigma.cwiseAbs2().asDiagonal();
    AddPrior(state_->wheels.data(), Eigen::Vector3d::Ones(), wheels, -1);
    for (std::size_t i = 0; i < input_.sensors.size(); ++i) {
      const BatchSensorSlot& slot = input_.sensors[i];
      const Eigen::Matrix4d covariance =
          slot.PriorSigma().cwiseAbs2().asDiagonal();
      AddPrior(state_->sensors[i].data(), slot.nominal, covariance, 2);
    }
  }

  void AddPrior(double* block,
                const Eigen::VectorXd& mean,
                const Eigen::MatrixXd& covariance,
                int wrapped) {
    factors_.push_back(
        {.kind = FactorKind::kPrior,
         .cost = std::make_unique<PriorCost>(mean, covariance, wrapped),
         .loss = nullptr,
         .blocks = {block}});
  }

  void AddLog(int index) {
    const BatchLogInput& log = input_.logs[static_cast<std::size_t>(index)];
    std::vector<BatchState::Keyframe>& keyframes =
        state_->logs[static_cast<std::size_t>(index)];
    const WheelParameters wheels = state_->Wheels(options_.initial);
    const Eigen::Vector3d gauge(kGaugeSigmaM, kGaugeSigmaM, kGaugeSigmaRad);
    AddPrior(keyframes[0].pose.data(),
             Eigen::Vector3d(keyframes[0].pose.data()),
             gauge.cwiseAbs2().asDiagonal().toDenseMatrix(),
             2);
    if (log.start) {
      BatchState::Keyframe& at = keyframes[KeyframeAt(
          keyframes, log.track.SecondsAt(log.start->time))];
      AddPrior(
          at.pose.data(), log.start->X_WR.vector(), log.start->covariance, 2);
    }
    for (std::size_t i = 0; i + 1 < keyframes.size(); ++i) {
      const double t0 = keyframes[i].time;
      const double t1 = keyframes[i + 1].time;
      factors_.push_back(
          {.kind = FactorKind::kStep,
           .cost = std::make_unique<StepCost>(
               StepModel{&log.track, options_.initial, options_.integration},
               t0,
               t1,
               StepCovariance(log.track, t0, t1, wheels, options_)),
           .loss = MakeLoss(options_.odometry_loss, scale_ * std::sqrt(3.0)),
           .blocks = {keyframes[i].pose.data(),
                      keyframes[i + 1].pose.data(),
                      state_->wheels.data()},
           .log = index});
    }
    AddMeasurements(log, index, &keyframes);
  }

  void AddMeasurements(const BatchLogInput& log,
                       int index,
                       std::vector<BatchState::Keyframe>* keyframes) {
    for (std::size_t i = 0; i < log.fixes.size(); ++i) {
      const BatchFixInput& fix = log.fixes[i];
      auto [at, tie] = Tie(log, fix.time, fix.sensor, keyframes);
      auto cost = std::make_unique<FixCost>(tie, *fix.fix);
      const double size = std::sqrt(cost->num_residuals());
      factors_.push_back({.kind = FactorKind::kFix,
                          .cost = std::move(cost),
                          .loss = MakeLoss(loss_, scale_ * size),
                          .blocks = {at, SensorBlock(fix.sensor)},
                          .log = index,
                          .index = static_cast<int>(i),
                          .sensor = fix.sensor});
    }
    for (std::size_t i = 0; i < log.motions.size(); ++i) {
      const BatchMotionInput& motion = log.motions[i];
      auto [at0, tie0] = Tie(log, motion.from, motion.sensor, keyframes);
      auto [at1, tie1] = Tie(log, motion.time, motion.sensor, keyframes);
      if (at0 == at1) continue;  // Shorter than keyframe_s: tells nothing.
      factors_.push_back(
          {.kind = FactorKind::kMotion,
           .cost = std::make_unique<MotionCost>(tie0, tie1, *motion.motion),
           .loss = MakeLoss(loss_, scale_ * std::sqrt(3.0)),
           .blocks = {at0, at1, SensorBlock(motion.sensor)},
           .log = index,
           .index = static_cast<int>(i),
           .sensor = motion.sensor});
    }
  }

  double* SensorBlock(int sensor) {
    return state_->sensors[static_cast<std::size_t>(sensor)].data();
  }

  // The nearest keyframe. Not the last one before `time`: where the time offset
  // moved by a hair since the keyframes were set, that would be the one a whole
  // step earlier, tied by ticks whose noise is then left out.
  static std::size_t KeyframeAt(const std::vector<BatchState::Keyframe>& all,
                                double time) {
    const auto above = std::upper_bound(
        all.begin(), all.end(), time, [](double t, const auto& keyframe) {
          return t < keyframe.time;
        });
    if (above == all.begin()) return 0;
    const auto below = above - 1;
    const bool is_above =
        above != all.end() && above->time - time < time - below->time;
    return static_cast<std::size_t>((is_above ? above : below) - all.begin());
  }

  std::pair<double*, KeyframeTie> Tie(
      const BatchLogInput& log,
      double sensor_time,
      int sensor,
      std::vector<BatchState::Keyframe>* keyframes) {
    const double offset = state_->sensors[static_cast<std::size_t>(sensor)][3];
    BatchState::Keyframe& at =
        (*keyframes)[KeyframeAt(*keyframes, sensor_time - offset)];
    return {at.pose.data(),
            MakeTie({&log.track,
                     state_->Wheels(options_.initial),
                     options_.integration,
                     at.time,
                     sensor_time,
                     offset,
                     {}},
                    offset)};
  }

  const BatchInput& input_;
  const BatchOptions& options_;
  BatchLoss loss_;
  double scale_;
  BatchState* state_;
  std::vector<BatchFactor> factors_;
};

}  // namespace

BatchState FirstState(const BatchInput& input, const BatchOptions& options) {
  BatchState state;
  for (const BatchSensorSlot& slot : input.sensors) {
    std::array<double, 4> block{};
    Eigen::Map<Eigen::Vector4d>(block.data()) = slot.nominal;
    state.sensors.push_back(block);
  }
  for (const BatchLogInput& log : input.logs) {
    std::vector<BatchState::Keyframe> keyframes;
    if (!log.track.empty()) {
      const std::vector<double> times =
          KeyframeTimes(log, state.sensors, options.keyframe_s);
      const std::vector<Eigen::Vector3d> poses =
          GuessTrajectory(log, input.sensors, times, options);
      for (std::size_t i = 0; i < times.size(); ++i) {
        keyframes.push_back(
            {times[i], {poses[i](0), poses[i](1), poses[i](2)}});
      }
    }
    state.logs.push_back(std::move(keyframes));
  }
  return state;
}

void RenewKeyframes(const BatchInput& input,
                    const BatchOptions& options,
                    BatchState* state) {
  const WheelParameters wheels = state->Wheels(options.initial);
  for (std::size_t i = 0; i < input.logs.size(); ++i) {
    const BatchLogInput& log = input.logs[i];
    const std::vector<BatchState::Keyframe>& old = state->logs[i];
    if (old.empty()) continue;
    std::vector<BatchState::Keyframe> renewed;
    std::size_t from = 0;
    for (const double time :
         KeyframeTimes(log, state->sensors, options.keyframe_s)) {
      while (from + 1 < old.size() && old[from + 1].time <= time) ++from;
      const Pose2 shift = log.track
                              .Integrate(old[from].time,
                                         time,
                                         wheels,
                                         DriveNoise{},
                                         options.integration)
                              .X_R0R1;
      const std::array<double, 3>& pose = old[from].pose;
      const Pose2 X_WR = Pose2{pose[0], pose[1], WrapAngle(pose[2])} * shift;
      renewed.push_back({time, {X_WR.x, X_WR.y, pose[2] + shift.heading}});
    }
    state->logs[i] = std::move(renewed);
  }
}

std::vector<BatchFactor> BuildFactors(const BatchInput& input,
                                      const BatchOptions& options,
                                      BatchLoss loss,
                                      BatchState* state) {
  return Builder(input, options, loss, state).Build();
}

double InlierGate(int num_components) {
  // Quantiles 0.999 of chi-squared with 1, 2, 3 degrees of freedom.
  constexpr std::array<double, 3> kGates{10.828, 13.816, 16.266};
  WAYMARK_CHECK(num_components >= 1 && num_components <= 3, num_components);
  return kGates[static_cast<std::size_t>(num_components - 1)];
}

}  // namespace waymark
