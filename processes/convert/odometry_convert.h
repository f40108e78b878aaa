// Odometry messages to values and back. What comes in is checked here once:
// behind these functions every number is finite and every covariance usable.
#pragma once

#include "estimation/filter/estimate_types.h"
#include "estimation/filter/measurement_types.h"

#include <waymark/bot_pose_t.hpp>
#include <waymark/encoders_t.hpp>
#include <waymark/initial_pose_t.hpp>
#include <waymark/odometry_parameters_t.hpp>
#include <waymark/pose_t.hpp>
#include <waymark/position_fix_t.hpp>
#include <waymark/relative_motion_t.hpp>

#include <cstdint>
#include <optional>
#include <string>

namespace waymark {

// Each returns nullopt and sets *reason (what, value, allowed range) where the
// content cannot be used: time stamp not positive, number not finite or beyond
// 10 000 km, covariance not symmetric or not positive definite. Headings are
// wrapped. `reason` must not be null.

// Counts as sent, wraps still in them: pass them through EncoderCounter with
// the message's counter_bits, which is checked here (0, or 8 to 52).
[[nodiscard]] std::optional<EncoderReading> EncoderReadingFromMessage(
    const encoders_t& message, std::string* reason);

// At least one component is present; the covariance block of the present ones
// is positive definite.
[[nodiscard]] std::optional<AbsoluteFix> AbsoluteFixFromMessage(
    const position_fix_t& message, std::string* reason);

// utime_from < utime.
[[nodiscard]] std::optional<RelativeMotion> RelativeMotionFromMessage(
    const relative_motion_t& message, std::string* reason);

// The covariance may be singular (zero: exactly known).
[[nodiscard]] std::optional<InitialPose> InitialPoseFromMessage(
    const initial_pose_t& message, std::string* reason);

// k_right and k_left are at least 1e-12 m per tick, wheel_base at least 1 mm;
// the covariance may be singular (zero: no statement). Where the message is not
// is_known, its numbers are neither checked nor taken.
[[nodiscard]] std::optional<OdometryParameters> OdometryParametersFromMessage(
    const odometry_parameters_t& message, std::string* reason);

// What a pose_filter believes. The covariance may be singular. Where the
// message is not is_known, its numbers are neither checked nor taken.
[[nodiscard]] std::optional<PoseEstimate> PoseEstimateFromMessage(
    const pose_t& message, std::string* reason);

[[nodiscard]] encoders_t ToMessage(const EncoderReading& reading,
                                   int counter_bits,
                                   bool is_virtual);
[[nodiscard]] position_fix_t ToMessage(const AbsoluteFix& fix);
[[nodiscard]] relative_motion_t ToMessage(const RelativeMotion& motion);
[[nodiscard]] initial_pose_t ToMessage(const InitialPose& pose);
[[nodiscard]] odometry_parameters_t ToMessage(const OdometryParameters& values,
                                              std::int64_t seq);
[[nodiscard]] pose_t ToMessage(const PoseEstimate& estimate, std::int64_t seq);

// The same estimate for viewers of bot_core. Only for a known pose.
[[nodiscard]] bot_pose_t ToBotMessage(const PoseEstimate& estimate);

}  // namespace waymark
