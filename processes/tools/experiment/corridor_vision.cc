#include "processes/tools/experiment/corridor_vision.h"

#include "estimation/geometry/angle.h"
#include "processes/convert/corridor_convert.h"
#include "processes/support/channels.h"

#include <waymark/truth_t.hpp>

#include <algorithm>
#include <cmath>

namespace waymark {

void CorridorVisionOptions::Describe(Describer& d) {
  constexpr Range kMetres{0.0, 10.0};
  constexpr Range kRadians{0.0, 3.0};
  constexpr Range kShare{0.0, 1.0};
  d.Number("rate_hz", &rate_hz, {0.1, 100.0}, "Images a second");
  d.Number("latency_s", &latency_s, {0.0, 2.0}, "From image to answer");
  d.Number("sigma_m", &sigma_m, kMetres, "Of y, from image to image");
  d.Number("sigma_rad", &sigma_rad, kRadians, "Of the heading");
  d.Number("slow_sigma_m", &slow_sigma_m, kMetres, "Of what changes slowly");
  d.Number("slow_sigma_rad", &slow_sigma_rad, kRadians, "in y and heading");
  d.Number("correlation_s",
           &correlation_s,
           {0.01, 1000.0},
           "Time in which that changes");
  d.Number("stated_sigma_m",
           &stated_sigma_m,
           {1e-5, 10.0},
           "What it says of its error of y");
  d.Number(
      "stated_sigma_rad", &stated_sigma_rad, {1e-5, 3.0}, "and of the heading");
  d.Number("accepted_share", &accepted_share, kShare, "Of images");
  d.Degrees("max_heading_deg",
            &max_heading_rad,
            {1.0, 90.0},
            "Farther off the axis there is no answer");
  d.Number("faulty_share", &faulty_share, kShare, "Of answers");
  d.Number("faulty_sigma_m", &faulty_sigma_m, kMetres, "Of those, in y");
  d.Number("faulty_sigma_rad", &faulty_sigma_rad, kRadians, "in heading");
}

CorridorVision::CorridorVision(
    const CorridorVisionOptions& options,
    const CorridorGeometry& corridor,
    const std::optional<Eigen::Vector2d>& blind_way_m,
    std::uint64_t seed,
    LocalBus* bus)
    : options_(options),
      corridor_(corridor),
      blind_way_m_(blind_way_m),
      random_(SeedFor(seed, "corridor vision")),
      bus_(bus) {
  bus->bus()->Subscribe<truth_t>(
      kTruth, Keep::All(), [this](const truth_t& truth, Time t) {
        OnTruth({truth.x, truth.y, truth.heading}, t);
      });
}

void CorridorVision::OnTruth(const Pose2& X_WR, Time time) {
  if (last_) way_m_ += (X_WR.position() - last_->position()).norm();
  last_ = X_WR;
  if (time < next_) return;
  // TRUTH comes at a rate of its own: on average the image rate is kept.
  const Duration period = DurationFromSeconds(1.0 / options_.rate_hz);
  next_ = std::max(next_, time - period) + period;
  CorridorAnswer answer;
  answer.time = time;
  answer.seq = seq_++;
  answer.source = "MODEL";
  answer.corridor = corridor_;
  answer.estimate = EstimateAt(Between(corridor_.X_WL, X_WR));
  bus_->PublishAt(time + DurationFromSeconds(options_.latency_s),
                  kCorridorPose,
                  ToMessage(answer));
}

CorridorEstimate CorridorVision::EstimateAt(const Pose2& X_LR) {
  // Drawn also where nothing is seen: what comes later does not depend on it.
  const Eigen::Vector2d error = DrawError();
  const bool is_accepted = random_.Uniform(0.0, 1.0) < options_.accepted_share;
  CorridorEstimate estimate;
  if (blind_way_m_ && way_m_ >= (*blind_way_m_)(0) &&
      way_m_ < (*blind_way_m_)(1)) {
    estimate.status = CorridorStatus::kNoLines;
    estimate.reason = "the lens is covered";
    return estimate;
  }
  // A corridor looks the same in both directions.
  const double off = std::abs(X_LR.heading);
  const double off_axis = std::min(off, kPi - off);
  if (!is_accepted || off_axis > options_.max_heading_rad) {
    estimate.status = CorridorStatus::kNoVanishingPoint;
    estimate.reason = "no vanishing point of the axis";
    return estimate;
  }
  estimate.status = CorridorStatus::kAccepted;
  estimate.y = X_LR.y + error(0);
  estimate.heading = WrapAngle(X_LR.heading + error(1));
  estimate.covariance =
      Eigen::Vector2d(options_.stated_sigma_m * options_.stated_sigma_m,
                      options_.stated_sigma_rad * options_.stated_sigma_rad)
          .asDiagonal();
  estimate.p_regular = 1.0;
  return estimate;
}

Eigen::Vector2d CorridorVision::DrawError() {
  const Eigen::Vector2d fast(random_.Normal(options_.sigma_m),
                             random_.Normal(options_.sigma_rad));
  const Eigen::Vector2d drawn(random_.Normal(options_.slow_sigma_m),
                              random_.Normal(options_.slow_sigma_rad));
  // A Gauss-Markov process: its variance is the same at all times.
  const double keep =
      has_slow_ ? std::exp(-1.0 / (options_.rate_hz * options_.correlation_s))
                : 0.0;
  slow_ = keep * slow_ + std::sqrt(1.0 - keep * keep) * drawn;
  has_slow_ = true;
  const bool is_faulty = random_.Uniform(0.0, 1.0) < options_.faulty_share;
  const Eigen::Vector2d fault(random_.Normal(options_.faulty_sigma_m),
                              random_.Normal(options_.faulty_sigma_rad));
  Eigen::Vector2d error = fast + slow_;
  if (is_faulty) error += fault;
  return error;
}

}  // namespace waymark
