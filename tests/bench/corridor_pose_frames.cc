#include "tests/bench/corridor_pose_frames.h"

#include "drivers/simulator/build_scene.h"
#include "estimation/geometry/angle.h"
#include "estimation/geometry/pose3.h"
#include "processes/convert/corridor_file.h"
#include "processes/convert/world_file.h"

#include <Eigen/LU>
#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <cmath>
#include <utility>

namespace waymark {
namespace {

constexpr double kRobotRadius = 0.25;  // m.

bool IsFree(const World& world,
            const std::vector<Pose2>& people,
            const Pose2& X_WR) {
  for (const WorldFurniture& thing : world.furniture) {
    const double reach = 0.5 * std::hypot(thing.size.x(), thing.size.y());
    if ((thing.at - X_WR.position()).norm() < reach + kRobotRadius) {
      return false;
    }
  }
  return std::all_of(people.begin(), people.end(), [&](const Pose2& person) {
    return (person.position() - X_WR.position()).norm() >
           kPersonRadius + kRobotRadius;
  });
}

}  // namespace

CorridorPrior DrawPrior(const Pose2& X_LR,
                        const PriorErrors& errors,
                        Random* random) {
  CorridorPrior prior;
  prior.X_LR = X_LR;
  prior.X_LR.x += random->Normal(errors.x);
  prior.X_LR.y += random->Normal(errors.y);
  prior.X_LR.heading = WrapAngle(X_LR.heading + random->Normal(errors.heading));
  prior.covariance.diagonal() << errors.x * errors.x, errors.y * errors.y,
      errors.heading * errors.heading;
  return prior;
}

CorridorPoseFrames::CorridorPoseFrames(const std::string& world,
                                       std::uint64_t seed,
                                       double max_heading)
    : world_(LoadWorldFile(FindWorldFile(world))),
      max_heading_(max_heading),
      corridors_(LoadCorridorFile(FindCorridorFile(world))),
      camera_(LoadCameraFile(FindCameraFile("perspective"))),
      renderer_(BuildScene(world_)),
      people_(world_, {}),
      rays_(CameraView{camera_.model, camera_.size}),
      random_(SeedFor(seed, world)) {}

Pose2 CorridorPoseFrames::DrawPose(const CorridorGeometry& corridor) {
  Pose2 X_LR;
  X_LR.x = random_.Uniform(corridor.x_min + 0.4, corridor.x_max - 0.4);
  const double side = 0.5 * corridor.width.value() - kRobotRadius - 0.05;
  X_LR.y = random_.Uniform(-side, side);
  const double turn = random_.Uniform() < 0.5 ? 0.0 : kPi;
  X_LR.heading = WrapAngle(turn + random_.Uniform(-max_heading_, max_heading_));
  return X_LR;
}

CorridorPoseFrame CorridorPoseFrames::Next() {
  while (true) {
    CorridorPoseFrame frame;
    frame.corridor = corridors_[next_];
    frame.X_LR = DrawPose(frame.corridor);
    const Pose2 X_WR = frame.corridor.X_WL * frame.X_LR;
    const auto people = people_.PosesAt(random_.Uniform(0.0, 60.0), X_WR);
    if (!IsFree(world_, people, X_WR)) continue;
    next_ = (next_ + 1) % corridors_.size();
    std::vector<Eigen::Isometry3d> X_WP;
    for (const Pose2& pose : people) X_WP.push_back(SpatialPose(pose));
    const cv::Mat3b image =
        renderer_.Render(rays_, SpatialPose(X_WR) * camera_.X_RC, X_WP).image;
    cv::cvtColor(image, frame.image, cv::COLOR_BGR2GRAY);
    frame.prior = DrawPrior(frame.X_LR, {}, &random_);
    return frame;
  }
}

void PoseScore::Add(const CorridorEstimate& found,
                    const Pose2& X_LR,
                    double time_ms) {
  ++num_frames;
  times_ms.push_back(time_ms);
  if (found.status != CorridorStatus::kAccepted) return;
  const Eigen::Vector2d error(found.y.value() - X_LR.y,
                              WrapAngle(found.heading.value() - X_LR.heading));
  const double y = std::abs(error.x());
  const double heading = std::abs(error.y());
  y_errors.push_back(y);
  heading_errors.push_back(heading);
  worst_sigmas.push_back(std::max(y / std::sqrt(found.covariance(0, 0)),
                                  heading / std::sqrt(found.covariance(1, 1))));
  nees.push_back(error.dot(found.covariance.inverse() * error));
}

double PoseScore::AcceptedPercent() const {
  return num_frames == 0
             ? 0.0
             : 100.0 * static_cast<double>(y_errors.size()) / num_frames;
}

double PoseScore::PercentBeyond(double sigmas) const {
  if (worst_sigmas.empty()) return 0.0;
  const auto num = std::count_if(worst_sigmas.begin(),
                                 worst_sigmas.end(),
                                 [&](double s) { return s > sigmas; });
  return 100.0 * static_cast<double>(num) /
         static_cast<double>(worst_sigmas.size());
}

}  // namespace waymark
