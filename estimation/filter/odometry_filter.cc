#include "estimation/filter/odometry_filter.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace waymark {
namespace {

constexpr const char* kNominal = "nominal";
constexpr const char* kBatch = "batch";
constexpr const char* kNoParameters =
    "no wheel parameters: none configured, none received";
// From here on disagreement is blamed on the first fix: with fewer, one or two
// faulty ones among the others would do as well.
constexpr int kManyFixes = 8;
// Doubt doubles the standard deviations of the wheel parameters, up to a fifth
// of their values: beyond, a linear model of them says little.
constexpr double kDoubt = 2.0;
constexpr double kMostDoubt = 0.2;
// Where a relocalising fix does not measure a direction, m.
constexpr double kRelocaliseSigma = 10.0;

}  // namespace

OdometryFilter::OdometryFilter(const OdometryFilterOptions& options)
    : options_(options),
      counter_(options.counter),
      unknown_("no first pose: none configured, none received") {
  options_.ekf.estimate_parameters = !options_.adopt_batch;
  if (options_.parameters) {
    nominal_ = options_.parameters;
    OdometryParameters nominal;
    nominal.source = kNominal;
    nominal.parameters = *options_.parameters;
    SetDrive(nominal);
  }
  if (options_.learned) {
    SetDrive(*options_.learned);
    if (!nominal_) nominal_ = options_.learned->parameters;
  }
}

void OdometryFilter::SetDrive(const OdometryParameters& parameters) {
  drive_ = parameters;
  if (drive_->covariance.isZero(0.0)) {
    drive_->covariance = parameters.parameters.vector()
                             .cwiseProduct(options_.parameter_sigma)
                             .cwiseAbs2()
                             .asDiagonal();
  }
  prior_variances_ = drive_->covariance.diagonal();
  const double smallest =
      std::min(drive_->parameters.k_right, drive_->parameters.k_left);
  counter_.set_max_tick_rate(options_.max_wheel_speed / smallest);
  if (ekf_) ekf_->SetParameters(drive_->parameters, drive_->covariance);
}

void OdometryFilter::Add(Time time, Measurement measurement) {
  held_.push_back({time, std::move(measurement)});
}

void OdometryFilter::AddReading(const EncoderReading& raw, int counter_bits) {
  const EncoderStep step = counter_.Add(raw, counter_bits);
  if (!step.is_accepted) {
    ++counts_.num_refused_readings;
    // A second reading of the same time says nothing against the first.
    if (step.seconds <= 0.0) return;
  }
  time_ = raw.time;
  has_reading_ = true;
  refused_ = step.is_accepted ? "" : step.reason;
  if (!step.is_accepted) return;
  last_ticks_ = step.ticks;
  last_seconds_ = step.seconds;
  const std::vector<Held> held = std::exchange(held_, {});
  if (step.is_first) {
    ApplyAtFirstReading(held);
    return;
  }
  if (step.unknown_s > 0.0) MoveUnmeasured(step.unknown_s);
  const Duration interval = DurationFromSeconds(step.seconds);
  const Time from = raw.time - interval;
  double done = 0.0;
  const auto move_to = [&](double share) {
    const double part = share - done;
    if (part <= 0.0) return;
    Move({step.ticks.right * part, step.ticks.left * part},
         step.seconds * part);
    done = share;
  };
  for (const Held& item : held) {
    move_to(std::clamp(Seconds(item.time - from) / step.seconds, done, 1.0));
    std::visit([&](const auto& m) { Apply(item.time, m); }, item.measurement);
  }
  move_to(1.0);
  if (ekf_ && ekf_->num_clones() > 0) ekf_->DropClones(raw.time);
  if (step.seconds > options_.max_gap_s && drive_) {
    const double travel =
        0.5 * (std::abs(drive_->parameters.k_right * step.ticks.right) +
               std::abs(drive_->parameters.k_left * step.ticks.left));
    const double sigma = options_.gap_share * travel;
    const Eigen::Matrix3d noise =
        Eigen::Vector3d(sigma * sigma, sigma * sigma, 0.0).asDiagonal();
    if (ekf_) ekf_->AddPoseNoise(noise);
    odometry_covariance_ += noise;
  }
  Start();
}

void OdometryFilter::ApplyAtFirstReading(const std::vector<Held>& held) {
  const auto apply = [&](const Held& item) {
    std::visit([&](const auto& m) { Apply(item.time, m); }, item.measurement);
  };
  const auto starts_motion = [](const Held& item) {
    return std::holds_alternative<MotionStart>(item.measurement);
  };
  for (const Held& item : held) {
    if (starts_motion(item)) continue;
    if (std::holds_alternative<AbsoluteFix>(item.measurement) &&
        item.time < time_) {
      ++counts_.num_unused;
    } else {
      apply(item);
    }
  }
  Start();
  // These need the pose that Start may give.
  for (const Held& item : held) {
    if (starts_motion(item) && item.time == time_) apply(item);
  }
}

// The configured start holds from the first reading with known parameters on.
void OdometryFilter::Start() {
  if (!options_.start || !drive_) return;
  Apply(time_, *options_.start);
  options_.start.reset();
}

void OdometryFilter::Move(const WheelTicks& ticks, double seconds) {
  if (!drive_ && (ticks.right != 0.0 || ticks.left != 0.0)) {
    options_.start.reset();
  }
  if (ekf_) ekf_->Predict(ticks, seconds);
  if (aligner_) aligner_->AddMotion(ticks);
  if (relocaliser_) relocaliser_->AddMotion(ticks);
  if (!nominal_) return;
  const DriveStep step = IntegrateTicks(
      ticks, *nominal_, options_.ekf.noise, options_.ekf.integration);
  const ComposeJacobians J = JacobiansOfCompose(X_OR_, step.X_R0R1);
  odometry_covariance_ = (J.d_AB * odometry_covariance_ * J.d_AB.transpose() +
                          J.d_BC * step.covariance * J.d_BC.transpose())
                             .eval();
  X_OR_ = X_OR_ * step.X_R0R1;
}

// Each wheel may have done anything up to its fastest: uniform, so sigma is
// the bound by the root of three.
void OdometryFilter::MoveUnmeasured(double seconds) {
  ++counts_.num_lost_counts;
  if (!drive_) return;
  const double position = options_.max_wheel_speed * seconds / std::sqrt(3.0);
  const double heading = 2.0 * position / drive_->parameters.wheel_base;
  const Eigen::Matrix3d noise =
      Eigen::Vector3d(
          position * position, position * position, heading * heading)
          .asDiagonal();
  odometry_covariance_ += noise;
  if (aligner_ || relocaliser_) {
    aligner_.reset();
    relocaliser_.reset();
  }
  if (!ekf_) return;
  if (heading > options_.max_lost_heading_sigma) {
    LosePose("pose lost: the encoders' counts were lost");
  } else {
    ekf_->AddPoseNoise(noise);
  }
}

void OdometryFilter::LosePose(std::string reason) {
  if (ekf_ && ekf_->fault().empty()) {
    prior_variances_ = ekf_->prior_variances();
    drive_->parameters = ekf_->parameters();
    drive_->covariance = ekf_->parameter_covariance();
  }
  ekf_.reset();
  unknown_ = std::move(reason);
}

void OdometryFilter::Apply(Time /*time*/,
                           const OdometryParameters& parameters) {
  if (parameters.source == kNominal && !options_.parameters) {
    if (!nominal_) nominal_ = parameters.parameters;
    // Only as a start: what is known by now knows more.
    if (!drive_) SetDrive(parameters);
  } else if (parameters.source == kBatch && options_.adopt_batch) {
    SetDrive(parameters);
    aligner_.reset();
    relocaliser_.reset();
  }
}

void OdometryFilter::Apply(Time /*time*/, const InitialPose& pose) {
  if (!drive_) {
    // Holds until the wheels are known, unless the robot moves before.
    options_.start = pose;
    return;
  }
  // Exactly known is taken as a tenth of a millimetre: a singular covariance
  // has no normalised error.
  constexpr double kFloor = 1e-4;
  const Eigen::Matrix3d P =
      pose.covariance + kFloor * kFloor * Eigen::Matrix3d::Identity();
  if (ekf_ && ekf_->fault().empty()) {
    ekf_->SetPose(pose.X_WR, P);
  } else {
    ekf_.emplace(
        options_.ekf, pose.X_WR, P, drive_->parameters, drive_->covariance);
    ekf_->set_prior_variances(prior_variances_);
  }
  aligner_.reset();
  relocaliser_.reset();
}

void OdometryFilter::Apply(Time /*time*/, const AbsoluteFix& fix) {
  if (!drive_) {
    ++counts_.num_unused;
    return;
  }
  if (!ekf_) {
    Locate(fix);
    return;
  }
  if (!ekf_->fault().empty()) {
    ++counts_.num_unused;
    return;
  }
  const double regular =
      RegularProbability(fix.has, ekf_->Innovate(fix), options_.gate);
  if (regular > options_.gate.min_regular) {
    ekf_->Update(fix);
    ++counts_.num_accepted;
    // Headings alone may agree while the position is far off.
    if (fix.has[0] || fix.has[1]) relocaliser_.reset();
    if (relocaliser_) (void)relocaliser_->AddFix(fix);
    return;
  }
  ++counts_.num_rejected;
  Relocalise(fix);
}

void OdometryFilter::Apply(Time time, const MotionStart& start) {
  if (!ekf_) return;
  // Motions that end now came before.
  ekf_->DropClones(time + Duration(1));
  if (!ekf_->HasClone(time) && ekf_->num_clones() >= options_.max_clones) {
    ++counts_.num_crowded;
    return;
  }
  ekf_->AddClone(time, start.until);
}

// Rejection does not make the next motion any likelier to be accepted, since
// the wheels' uncertainty over a motion stays what it was. So that wrong
// parameters cannot lock the filter, a row of rejections makes it doubt them.
void OdometryFilter::Apply(Time /*time*/, const RelativeMotion& motion) {
  if (!ekf_ || !ekf_->fault().empty() || !ekf_->HasClone(motion.from)) {
    ++counts_.num_unused;
    return;
  }
  if (options_.ekf.mounting_position_sigma > 0.0 ||
      options_.ekf.mounting_yaw_sigma > 0.0) {
    if (!ekf_->HasMounting(motion.source) &&
        ekf_->num_mountings() >= options_.max_mountings) {
      ++counts_.num_crowded;
      return;
    }
    ekf_->AddMounting(motion.source);
  }
  const double regular = RegularProbability(
      {true, true, true}, ekf_->Innovate(motion), options_.gate);
  if (regular > options_.gate.min_regular) {
    ekf_->Update(motion);
    ++counts_.num_accepted;
    rejected_motions_ = 0;
    return;
  }
  ++counts_.num_rejected;
  if (++rejected_motions_ % options_.doubt_after != 0) return;
  ekf_->WidenParameters(kDoubt, kMostDoubt);
  ++counts_.num_doubts;
}

PoseAligner OdometryFilter::MakeAligner(const Pose2& guess,
                                        bool relocalising) const {
  PoseAlignerOptions options = options_.alignment;
  if (relocalising) {
    options.min_fixes = options_.relocalise_after;
    options.allow_partial = true;
    options.position_sigma = std::min(options.position_sigma, kRelocaliseSigma);
  }
  const bool learned = ekf_ && ekf_->fault().empty();
  return {options,
          options_.ekf,
          learned ? ekf_->parameters() : drive_->parameters,
          learned ? ekf_->parameter_covariance() : drive_->covariance,
          guess};
}

void OdometryFilter::Locate(const AbsoluteFix& fix) {
  if (!aligner_) aligner_ = MakeAligner(Pose2{}, false);
  if (!aligner_->AddFix(fix)) return;
  const Alignment alignment = aligner_->Solve();
  unknown_ = alignment.reason;
  if (alignment.disagrees && aligner_->num_fixes() >= kManyFixes) {
    aligner_->DropFirst();
  }
  if (!alignment.is_known) return;
  ekf_.emplace(
      options_.ekf, alignment.X_WR, alignment.parameters, alignment.covariance);
  ekf_->set_prior_variances(prior_variances_);
  counts_.num_accepted += alignment.num_fixes;
  counts_.num_rejected += aligner_->num_fixes() - alignment.num_fixes;
  aligner_.reset();
}

void OdometryFilter::Relocalise(const AbsoluteFix& fix) {
  if (!relocaliser_) relocaliser_ = MakeAligner(ekf_->X_WR(), true);
  if (!relocaliser_->AddFix(fix)) return;
  const Alignment alignment = relocaliser_->Solve();
  if (alignment.disagrees && relocaliser_->num_fixes() >= kManyFixes) {
    relocaliser_->DropFirst();
  }
  if (!alignment.is_known) return;
  const Eigen::Vector3d prior_variances = ekf_->prior_variances();
  ekf_.emplace(
      options_.ekf, alignment.X_WR, alignment.parameters, alignment.covariance);
  ekf_->set_prior_variances(prior_variances);
  relocaliser_.reset();
  ++counts_.num_relocalisations;
}

PoseEstimate OdometryFilter::estimate() const {
  PoseEstimate result;
  result.time = time_;
  result.num_accepted = counts_.num_accepted;
  result.num_rejected = counts_.num_rejected;
  if (!has_reading_) {
    result.reason = "no encoder readings yet";
  } else if (!refused_.empty()) {
    result.reason = refused_;
  } else if (!drive_) {
    result.reason = kNoParameters;
  } else if (!ekf_) {
    result.reason = unknown_;
  } else if (!ekf_->fault().empty()) {
    result.reason = ekf_->fault();
  } else {
    result.is_known = true;
    result.X_WR = ekf_->X_WR();
    result.covariance = ekf_->pose_covariance();
    const WheelParameters p = ekf_->parameters();
    if (last_seconds_ > 0.0) {
      const double right = p.k_right * last_ticks_.right / last_seconds_;
      const double left = p.k_left * last_ticks_.left / last_seconds_;
      result.forward_speed = 0.5 * (right + left);
      result.turn_rate = (right - left) / p.wheel_base;
    }
  }
  return result;
}

PoseEstimate OdometryFilter::odometry() const {
  PoseEstimate result;
  result.time = time_;
  if (!has_reading_) {
    result.reason = "no encoder readings yet";
  } else if (!refused_.empty()) {
    result.reason = refused_;
  } else if (!nominal_) {
    result.reason = kNoParameters;
  } else {
    result.is_known = true;
    result.X_WR = X_OR_;
    result.covariance = odometry_covariance_;
    if (last_seconds_ > 0.0) {
      const double right = nominal_->k_right * last_ticks_.right;
      const double left = nominal_->k_left * last_ticks_.left;
      result.forward_speed = 0.5 * (right + left) / last_seconds_;
      result.turn_rate = (right - left) / nominal_->wheel_base / last_seconds_;
    }
  }
  return result;
}

OdometryParameters OdometryFilter::parameters() const {
  OdometryParameters result = drive_.value_or(OdometryParameters{});
  result.is_known = drive_ && (!ekf_ || ekf_->fault().empty());
  result.reason = !drive_ ? kNoParameters : ekf_ ? ekf_->fault() : "";
  result.time = time_;
  result.source = "online";
  result.sensor.reset();
  result.num_measurements = counts_.num_accepted;
  if (ekf_ && ekf_->fault().empty()) {
    result.parameters = ekf_->parameters();
    result.covariance = ekf_->parameter_covariance();
    result.observability = ekf_->observability();
  } else {
    for (int i = 0; i < 3; ++i) {
      result.observability(i) =
          prior_variances_(i) > 0.0
              ? std::clamp(1.0 - result.covariance(i, i) / prior_variances_(i),
                           0.0,
                           1.0)
              : 0.0;
    }
  }
  return result;
}

std::string OdometryFilter::fault() const {
  if (!refused_.empty()) return refused_;
  return ekf_ ? ekf_->fault() : "";
}

}  // namespace waymark
