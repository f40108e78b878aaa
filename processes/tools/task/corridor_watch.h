// What a camera makes of a corridor while a task is under way, in words.
#pragma once

#include "estimation/geometry/pose2.h"

#include <waymark/corridor_pose_t.hpp>
#include <waymark/pose_t.hpp>
#include <waymark/truth_t.hpp>

#include <cstdint>
#include <map>
#include <optional>
#include <string>

namespace waymark {

class CorridorWatch {
 public:
  void OnAnswer(const corridor_pose_t& message);
  // Of POSE and, where a simulation tells it, TRUTH: in any order.
  void OnPose(const pose_t& message);
  void OnTruth(const truth_t& message);

  // Since the last call: how many images had an accepted answer, what most of
  // the others had, and the largest error of POSE across the corridor.
  // Empty without images.
  [[nodiscard]] std::string News();

 private:
  struct Pair {
    std::optional<Pose2> estimated;  // X_WR.
    std::optional<Pose2> truth;
  };
  void Compare(std::int64_t utime);

  std::optional<Pose2> X_WL_;
  std::map<std::int64_t, Pair> waiting_;  // By utime.
  std::int64_t num_images_ = 0;
  std::map<std::string, std::int64_t> statuses_;
  bool has_error_ = false;
  double error_m_ = 0.0;
  double error_rad_ = 0.0;
};

}  // namespace waymark
