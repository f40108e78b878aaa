// Set-up of the corridor system's tasks.
#pragma once

#include "processes/collision_guard/collision_guard_config.h"
#include "processes/corridor_tracker/corridor_tracker_config.h"
#include "processes/path_follower/task_follower_config.h"
#include "processes/pose_filter/pose_filter_config.h"
#include "processes/simulator/simulator_config.h"
#include "processes/tools/experiment/corridor_vision.h"

#include <cstdint>
#include <string>
#include <vector>

namespace waymark {

// Tasks 1, 2 and 3 of [1, section V.B], and that of its figure 5.
//
// [1] E. Bayramoglu et al. Mobile robot navigation in a corridor using visual
//     odometry. ICAR 2009.
enum class CorridorTask : std::uint8_t { kTurns, kZigzag, kBlind, kLearn };
enum class CorridorSight : std::uint8_t { kModel, kPixels };

struct CorridorExperimentConfig {
  CorridorTask task = CorridorTask::kTurns;
  CorridorSight sight = CorridorSight::kModel;
  std::string corridor;       // File or name; empty: the world's name.
  double begin_m = 2.0;       // Along the axis, where the way begins,
  double length_m = 10.0;     // how far it goes,
  std::int64_t num_legs = 4;  // and how often: two complete turns.
  double zigzag_m = 0.4;      // To both sides of the axis.
  double zigzag_step_m = 2.0;
  std::vector<double> blind_way_m{4.0, 10.0};
  // What the filter believes at first, over what is nominal (learn).
  double wrong_base = 0.22 / 0.27;
  double wrong_ratio = 1.1 / 0.99;
  double wrong_sigma = 0.2;  // That it allows for, as a share.
  // True over nominal, drawn for each seed: wheels as well known as the task
  // `learn` leaves them.
  double wheel_spread = 0.002;
  double base_spread = 0.002;
  double max_error_m = 0.03;
  double max_error_rad = RadiansFromDegrees(1.0);
  double relocate_m = 0.25;  // Of sight, after which that holds again.
  double max_duration_s = 600.0;
  CorridorVisionOptions model;
  double tracker_latency_s = 0.01;  // Of corridor_tracker.
  CorridorTrackerConfig corridor_tracker;
  SimulatorConfig simulator;
  PoseFilterConfig pose_filter;
  CollisionGuardConfig collision_guard;
  TaskFollowerConfig path_follower;

  CorridorExperimentConfig();
  void Describe(Describer& d);
  // Throws std::invalid_argument naming the key.
  void Check() const;

 private:
  void DescribeWay(Describer& d);
  void DescribeWheels(Describer& d);
};

}  // namespace waymark
