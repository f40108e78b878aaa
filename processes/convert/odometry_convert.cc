#include "processes/convert/odometry_convert.h"

#include "estimation/geometry/angle.h"
#include "processes/convert/message_check.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include <cmath>
#include <cstddef>
#include <vector>

namespace waymark {
namespace {

// Farther than a quarter of the earth nothing is a robot's coordinate; squares
// and products of such numbers stay far from overflow.
constexpr double kMaxCoordinate = 1e7;
// Doubles count exactly to 2^53; 2^52 leaves room for differences.
constexpr std::int64_t kMaxTicks = std::int64_t{1} << 52;

bool CheckNumber(const char* key, double value, std::string* reason) {
  return std::abs(value) <= kMaxCoordinate ||
         Refuse(reason, key, ": ", value, " must be within +-", kMaxCoordinate);
}

bool CheckPose(const char* key, const double (&v)[3], std::string* reason) {
  for (const double value : v) {
    if (!CheckNumber(key, value, reason)) return false;
  }
  return true;
}

Pose2 PoseFrom(const double (&v)[3]) {
  return {v[0], v[1], WrapAngle(v[2])};
}

void CopyPose(const Pose2& X, double (&v)[3]) {
  v[0] = X.x;
  v[1] = X.y;
  v[2] = X.heading;
}

template <int N, std::size_t M>
Eigen::Matrix<double, N, N> MatrixFrom(const double (&v)[M]) {
  static_assert(N * N == M);
  return Eigen::Map<const Eigen::Matrix<double, N, N, Eigen::RowMajor>>(v);
}

template <int N, std::size_t M>
void CopyMatrix(const Eigen::Matrix<double, N, N>& matrix, double (&v)[M]) {
  static_assert(N * N == M);
  Eigen::Map<Eigen::Matrix<double, N, N, Eigen::RowMajor>> target(&v[0]);
  target = matrix;
}

enum class Definite { kPositive, kSemi };

// Judges the rows and columns in `use`. Scaling by the diagonal first makes
// metres and radians comparable.
template <typename Matrix>
bool CheckCovariance(const char* key,
                     const Matrix& P,
                     const std::vector<int>& use,
                     Definite kind,
                     std::string* reason) {
  const auto n = static_cast<Eigen::Index>(use.size());
  Eigen::MatrixXd block(n, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    for (Eigen::Index j = 0; j < n; ++j) {
      block(i, j) =
          P(use[static_cast<std::size_t>(i)], use[static_cast<std::size_t>(j)]);
      if (!CheckNumber(key, block(i, j), reason)) return false;
    }
  }
  Eigen::VectorXd scale(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const bool ok =
        kind == Definite::kPositive ? block(i, i) > 0.0 : block(i, i) >= 0.0;
    if (!ok) {
      return Refuse(
          reason, key, ": variance ", block(i, i), " must be positive");
    }
    scale(i) = block(i, i) > 0.0 ? 1.0 / std::sqrt(block(i, i)) : 1.0;
  }
  block = (scale.asDiagonal() * block * scale.asDiagonal()).eval();
  // Rounding of a float that was once written to text.
  constexpr double kAsymmetry = 1e-6;
  if (!((block - block.transpose()).cwiseAbs().maxCoeff() <= kAsymmetry)) {
    return Refuse(reason, key, ": covariance must be symmetric");
  }
  const double smallest = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(
                              block, Eigen::EigenvaluesOnly)
                              .eigenvalues()
                              .minCoeff();
  // Of a correlation matrix: below 1e-9 its inverse has lost half of the
  // digits; a semidefinite one may be negative by rounding only.
  const double limit = kind == Definite::kPositive ? 1e-9 : -1e-9;
  return smallest >= limit ||
         Refuse(reason,
                key,
                kind == Definite::kPositive
                    ? ": covariance must be positive definite"
                    : ": covariance must be positive semidefinite");
}

std::int32_t Narrow(std::int64_t count) {
  return static_cast<std::int32_t>(count);
}

}  // namespace

std::optional<EncoderReading> EncoderReadingFromMessage(
    const encoders_t& message, std::string* reason) {
  if (!CheckTime("utime", message.utime, reason)) return std::nullopt;
  constexpr int kMinBits = 8;
  constexpr int kMaxBits = 52;
  if (message.counter_bits != 0 &&
      (message.counter_bits < kMinBits || message.counter_bits > kMaxBits)) {
    Refuse(reason,
           "counter_bits: ",
           static_cast<int>(message.counter_bits),
           " must be 0 or 8 to 52");
    return std::nullopt;
  }
  for (const std::int64_t ticks : {message.right_ticks, message.left_ticks}) {
    if (ticks > kMaxTicks || ticks < -kMaxTicks) {
      Refuse(reason, "ticks: ", ticks, " must be within +-2^52");
      return std::nullopt;
    }
  }
  return EncoderReading{TimeFromMicroseconds(message.utime),
                        message.seq,
                        message.right_ticks,
                        message.left_ticks};
}

std::optional<AbsoluteFix> AbsoluteFixFromMessage(const position_fix_t& message,
                                                  std::string* reason) {
  AbsoluteFix fix;
  fix.time = TimeFromMicroseconds(message.utime);
  fix.seq = message.seq;
  fix.source = message.source;
  fix.has = {message.has_x != 0, message.has_y != 0, message.has_heading != 0};
  const double values[3] = {message.x, message.y, message.heading};
  constexpr const char* kKeys[3] = {"x", "y", "heading"};
  std::vector<int> use;
  for (int i = 0; i < 3; ++i) {
    if (!fix.has[static_cast<std::size_t>(i)]) continue;
    use.push_back(i);
    if (!CheckNumber(kKeys[i], values[i], reason)) return std::nullopt;
    fix.value(i) = i == 2 ? WrapAngle(values[i]) : values[i];
  }
  if (use.empty()) {
    Refuse(reason, "has_x, has_y, has_heading: one of them must be true");
    return std::nullopt;
  }
  const Eigen::Matrix3d P = MatrixFrom<3>(message.covariance);
  if (!CheckTime("utime", message.utime, reason) ||
      !CheckCovariance("covariance", P, use, Definite::kPositive, reason) ||
      !CheckPose("frame_W", message.frame_W, reason) ||
      !CheckPose("sensor_R", message.sensor_R, reason)) {
    return std::nullopt;
  }
  for (const int i : use) {
    for (const int j : use) fix.covariance(i, j) = 0.5 * (P(i, j) + P(j, i));
  }
  fix.X_WF = PoseFrom(message.frame_W);
  fix.X_RS = PoseFrom(message.sensor_R);
  return fix;
}

std::optional<RelativeMotion> RelativeMotionFromMessage(
    const relative_motion_t& message, std::string* reason) {
  const Eigen::Matrix3d P = MatrixFrom<3>(message.covariance);
  if (!CheckTime("utime", message.utime, reason) ||
      !CheckTime("utime_from", message.utime_from, reason) ||
      !CheckPose("motion", message.motion, reason) ||
      !CheckPose("sensor_R", message.sensor_R, reason) ||
      !CheckCovariance(
          "covariance", P, {0, 1, 2}, Definite::kPositive, reason)) {
    return std::nullopt;
  }
  if (message.utime_from >= message.utime) {
    Refuse(reason,
           "utime_from: ",
           message.utime_from,
           " must be before utime ",
           message.utime);
    return std::nullopt;
  }
  return RelativeMotion{TimeFromMicroseconds(message.utime_from),
                        TimeFromMicroseconds(message.utime),
                        message.seq,
                        message.source,
                        PoseFrom(message.motion),
                        0.5 * (P + P.transpose()),
                        PoseFrom(message.sensor_R)};
}

std::optional<InitialPose> InitialPoseFromMessage(const initial_pose_t& message,
                                                  std::string* reason) {
  const Eigen::Matrix3d P = MatrixFrom<3>(message.covariance);
  if (!CheckTime("utime", message.utime, reason) ||
      !CheckPose("pose_W", message.pose_W, reason) ||
      !CheckCovariance("covariance", P, {0, 1, 2}, Definite::kSemi, reason)) {
    return std::nullopt;
  }
  return InitialPose{TimeFromMicroseconds(message.utime),
                     message.seq,
                     message.source,
                     PoseFrom(message.pose_W),
                     0.5 * (P + P.transpose())};
}

std::optional<PoseEstimate> PoseEstimateFromMessage(const pose_t& message,
                                                    std::string* reason) {
  if (!CheckTime("utime", message.utime, reason)) return std::nullopt;
  PoseEstimate estimate;
  estimate.time = TimeFromMicroseconds(message.utime);
  estimate.is_known = message.is_known != 0;
  estimate.reason = message.reason;
  estimate.num_accepted = message.num_accepted;
  estimate.num_rejected = message.num_rejected;
  if (!estimate.is_known) return estimate;
  const Eigen::Matrix3d P = MatrixFrom<3>(message.covariance);
  if (!CheckPose("pose_W", message.pose_W, reason) ||
      !CheckCovariance("covariance", P, {0, 1, 2}, Definite::kSemi, reason) ||
      !CheckNumber("velocity_R", message.velocity_R[0], reason) ||
      !CheckNumber("velocity_R", message.velocity_R[1], reason)) {
    return std::nullopt;
  }
  estimate.X_WR = PoseFrom(message.pose_W);
  estimate.covariance = 0.5 * (P + P.transpose());
  estimate.forward_speed = message.velocity_R[0];
  estimate.turn_rate = message.velocity_R[1];
  return estimate;
}

std::optional<OdometryParameters> OdometryParametersFromMessage(
    const odometry_parameters_t& message, std::string* reason) {
  if (!CheckTime("utime", message.utime, reason)) return std::nullopt;
  OdometryParameters result;
  result.time = TimeFromMicroseconds(message.utime);
  result.source = message.source;
  result.is_known = message.is_known != 0;
  result.reason = message.reason;
  if (!result.is_known) return result;
  const double values[3] = {
      message.k_right, message.k_left, message.wheel_base};
  constexpr const char* kKeys[3] = {"k_right", "k_left", "wheel_base"};
  // Far below any robot, and far above where dividing by them overflows.
  constexpr double kLeast[3] = {1e-12, 1e-12, 1e-3};
  for (int i = 0; i < 3; ++i) {
    if (!CheckNumber(kKeys[i], values[i], reason)) return std::nullopt;
    if (!(values[i] > 0.0)) {
      Refuse(reason, kKeys[i], ": ", values[i], " must be positive");
      return std::nullopt;
    }
    if (values[i] < kLeast[i]) {
      Refuse(reason, kKeys[i], ": ", values[i], " must be >= ", kLeast[i]);
      return std::nullopt;
    }
  }
  const Eigen::Matrix3d P = MatrixFrom<3>(message.covariance);
  if (!CheckPose("observability", message.observability, reason) ||
      !CheckCovariance("covariance", P, {0, 1, 2}, Definite::kSemi, reason)) {
    return std::nullopt;
  }
  result.parameters = {message.k_right, message.k_left, message.wheel_base};
  result.covariance = 0.5 * (P + P.transpose());
  result.observability = Eigen::Vector3d(message.observability);
  result.num_measurements = message.num_measurements;
  if (message.has_sensor != 0) {
    const Eigen::Matrix4d P_S = MatrixFrom<4>(message.sensor_covariance);
    if (!CheckPose("sensor_R", message.sensor_R, reason) ||
        !CheckNumber("time_offset", message.time_offset, reason) ||
        !CheckCovariance(
            "sensor_covariance", P_S, {0, 1, 2, 3}, Definite::kSemi, reason)) {
      return std::nullopt;
    }
    result.sensor = SensorCalibration{message.sensor,
                                      PoseFrom(message.sensor_R),
                                      message.time_offset,
                                      0.5 * (P_S + P_S.transpose())};
  }
  return result;
}

encoders_t ToMessage(const EncoderReading& reading,
                     int counter_bits,
                     bool is_virtual) {
  encoders_t message{};
  message.utime = Microseconds(reading.time);
  message.seq = Narrow(reading.seq);
  message.left_ticks = reading.left;
  message.right_ticks = reading.right;
  message.counter_bits = static_cast<std::int8_t>(counter_bits);
  message.is_virtual = is_virtual ? 1 : 0;
  return message;
}

position_fix_t ToMessage(const AbsoluteFix& fix) {
  position_fix_t message{};
  message.utime = Microseconds(fix.time);
  message.seq = Narrow(fix.seq);
  message.source = fix.source;
  message.has_x = fix.has[0] ? 1 : 0;
  message.has_y = fix.has[1] ? 1 : 0;
  message.has_heading = fix.has[2] ? 1 : 0;
  message.x = fix.has[0] ? fix.value(0) : 0.0;
  message.y = fix.has[1] ? fix.value(1) : 0.0;
  message.heading = fix.has[2] ? fix.value(2) : 0.0;
  Eigen::Matrix3d P = fix.covariance;
  for (int i = 0; i < 3; ++i) {
    if (fix.has[static_cast<std::size_t>(i)]) continue;
    P.row(i).setZero();
    P.col(i).setZero();
  }
  CopyMatrix(P, message.covariance);
  CopyPose(fix.X_WF, message.frame_W);
  CopyPose(fix.X_RS, message.sensor_R);
  return message;
}

relative_motion_t ToMessage(const RelativeMotion& motion) {
  relative_motion_t message{};
  message.utime = Microseconds(motion.time);
  message.utime_from = Microseconds(motion.from);
  message.seq = Narrow(motion.seq);
  message.source = motion.source;
  CopyPose(motion.X_S0S1, message.motion);
  CopyMatrix(motion.covariance, message.covariance);
  CopyPose(motion.X_RS, message.sensor_R);
  return message;
}

initial_pose_t ToMessage(const InitialPose& pose) {
  initial_pose_t message{};
  message.utime = Microseconds(pose.time);
  message.seq = Narrow(pose.seq);
  message.source = pose.source;
  CopyPose(pose.X_WR, message.pose_W);
  CopyMatrix(pose.covariance, message.covariance);
  return message;
}

odometry_parameters_t ToMessage(const OdometryParameters& values,
                                std::int64_t seq) {
  odometry_parameters_t message{};
  message.utime = Microseconds(values.time);
  message.seq = Narrow(seq);
  message.source = values.source;
  message.is_known = values.is_known ? 1 : 0;
  message.reason = values.reason;
  message.k_right = values.parameters.k_right;
  message.k_left = values.parameters.k_left;
  message.wheel_base = values.parameters.wheel_base;
  CopyMatrix(values.covariance, message.covariance);
  for (int i = 0; i < 3; ++i) {
    message.observability[i] = values.observability(i);
  }
  message.num_measurements = values.num_measurements;
  message.has_sensor = values.sensor ? 1 : 0;
  if (values.sensor) {
    message.sensor = values.sensor->sensor;
    CopyPose(values.sensor->X_RS, message.sensor_R);
    message.time_offset = values.sensor->time_offset;
    CopyMatrix(values.sensor->covariance, message.sensor_covariance);
  }
  return message;
}

pose_t ToMessage(const PoseEstimate& estimate, std::int64_t seq) {
  pose_t message{};
  message.utime = Microseconds(estimate.time);
  message.seq = Narrow(seq);
  message.is_known = estimate.is_known ? 1 : 0;
  message.reason = estimate.reason;
  if (estimate.is_known) {
    CopyPose(estimate.X_WR, message.pose_W);
    CopyMatrix(estimate.covariance, message.covariance);
    message.velocity_R[0] = estimate.forward_speed;
    message.velocity_R[1] = estimate.turn_rate;
  }
  message.num_accepted = Narrow(estimate.num_accepted);
  message.num_rejected = Narrow(estimate.num_rejected);
  return message;
}

bot_pose_t ToBotMessage(const PoseEstimate& estimate) {
  bot_pose_t message{};
  message.utime = Microseconds(estimate.time);
  message.pos[0] = estimate.X_WR.x;
  message.pos[1] = estimate.X_WR.y;
  message.vel[0] = estimate.forward_speed * std::cos(estimate.X_WR.heading);
  message.vel[1] = estimate.forward_speed * std::sin(estimate.X_WR.heading);
  message.orientation[0] = std::cos(0.5 * estimate.X_WR.heading);
  message.orientation[3] = std::sin(0.5 * estimate.X_WR.heading);
  message.rotation_rate[2] = estimate.turn_rate;
  return message;
}

}  // namespace waymark
