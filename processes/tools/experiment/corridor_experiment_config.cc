#include "processes/tools/experiment/corridor_experiment_config.h"

#include "processes/tools/experiment/experiment_world.h"

#include <stdexcept>

namespace waymark {

CorridorExperimentConfig::CorridorExperimentConfig() {
  simulator.world = "corridor_plain";
  simulator.ranges = RangeKind::kLidar;
  simulator.second_camera.name.clear();
  // Twice what the true wheels differ by.
  pose_filter.nominal_sigma = {
      2.0 * wheel_spread, 2.0 * wheel_spread, 2.0 * base_spread};
}

void CorridorExperimentConfig::Describe(Describer& d) {
  d.Choice<CorridorTask>("task",
                         &task,
                         {{"turns", CorridorTask::kTurns},
                          {"zigzag", CorridorTask::kZigzag},
                          {"blind", CorridorTask::kBlind},
                          {"learn", CorridorTask::kLearn}},
                         "To and fro; zig-zag; straight on, blind on the way; "
                         "zig-zag with wrong wheel parameters");
  d.Choice<CorridorSight>(
      "sight",
      &sight,
      {{"model", CorridorSight::kModel}, {"pixels", CorridorSight::kPixels}},
      "Where CORRIDOR_POSE comes from: truth with errors, or images");
  d.Text("corridor", &corridor, "Corridor file, or name; empty: the world's");
  d.Group(
      "way", [&] { DescribeWay(d); }, "Where the robot drives");
  d.Group(
      "wheels",
      [&] { DescribeWheels(d); },
      "How its wheels differ from what the filter assumes");
  d.Number("max_error_m",
           &max_error_m,
           {1e-4, 10.0},
           "Success: POSE's lateral position is never farther off");
  d.Degrees("max_error_deg", &max_error_rad, {0.01, 180.0}, "and its heading");
  d.Number("relocate_m",
           &relocate_m,
           {0.0, 100.0},
           "of sight after blindness, from where on that holds again");
  d.Number("max_duration_s",
           &max_duration_s,
           {1.0, 100000.0},
           "What is not done by then has failed; simulated time");
  d.Group(
      "model", [&] { model.Describe(d); }, "Of CORRIDOR_POSE (sight: model)");
  d.Number("tracker_latency_s",
           &tracker_latency_s,
           {0.0, 2.0},
           "That corridor_tracker takes for an image (sight: pixels)");
  d.Group(
      "corridor_tracker",
      [&] { corridor_tracker.Describe(d); },
      "As in its own configuration; camera and corridors are those of the run");
  d.Group(
      "simulator",
      [&] { simulator.Describe(d); },
      "seed, start and true wheels vary");
  d.Group(
      "pose_filter",
      [&] { pose_filter.Describe(d); },
      "wheels, noise and start are the simulated robot's");
  d.Group(
      "collision_guard",
      [&] { collision_guard.Describe(d); },
      "As in its own configuration");
  d.Group(
      "path_follower",
      [&] { path_follower.Describe(d); },
      "As in its own configuration");
}

void CorridorExperimentConfig::DescribeWay(Describer& d) {
  d.Number("begin_m", &begin_m, {-1000.0, 1000.0}, "Along the axis");
  d.Number("length_m", &length_m, {0.5, 1000.0}, "From there, one way");
  d.Integer("num_legs", &num_legs, 1, 1000, "So often, to and fro");
  d.Number("zigzag_m", &zigzag_m, {0.0, 10.0}, "To both sides of the axis");
  d.Number("zigzag_step_m", &zigzag_step_m, {0.2, 100.0}, "Along it");
  d.Numbers("blind_m",
            &blind_way_m,
            2,
            "The camera is blind from the first to the second, of the way "
            "driven (task: blind)");
}

void CorridorExperimentConfig::DescribeWheels(Describer& d) {
  constexpr Range kFactor{0.3, 3.0};
  constexpr Range kShare{0.0, 0.3};
  d.Number("spread",
           &wheel_spread,
           kShare,
           "Sigma of the true wheels' travel, as a share, drawn for each seed");
  d.Number("base_spread", &base_spread, kShare, "and of the true wheel base");
  d.Number("wrong_base",
           &wrong_base,
           kFactor,
           "Assumed over nominal wheel base (task: learn)");
  d.Number("wrong_ratio",
           &wrong_ratio,
           kFactor,
           "Assumed over nominal ratio of right and left wheel (task: learn)");
  d.Number("wrong_sigma",
           &wrong_sigma,
           {1e-3, 1.0},
           "Sigma that the filter allows for then, as a share");
}

void CorridorExperimentConfig::Check() const {
  CheckForRuns(simulator);
  CheckHasNoFile("path_follower.task_file", path_follower.task_file);
  CheckHasNoFile("collision_guard.stop_file", collision_guard.stop_file);
  pose_filter.Check();
  corridor_tracker.Options().Check();
  collision_guard.Check();
  path_follower.Check();
  if (blind_way_m.size() == 2 && blind_way_m[0] > blind_way_m[1]) {
    throw std::invalid_argument(
        "way.blind_m: its end must not be before its beginning");
  }
}

}  // namespace waymark
