#include "processes/path_follower/task_file.h"

#include "estimation/base/input_error.h"
#include "processes/support/configuration.h"

#include <cstdint>
#include <filesystem>
#include <limits>
#include <vector>

namespace waymark {
namespace {

struct Contents {
  std::int64_t utime = 0;
  std::int64_t task_utime = 0;
  std::string source;
  std::string kind = "none";
  double max_speed = 0.0;
  std::int64_t num_reached = 0;
  std::vector<double> waypoints;

  void Describe(Describer& d) {
    constexpr std::int64_t kMost = std::numeric_limits<std::int64_t>::max();
    d.Integer("utime", &utime, 0, kMost, "Of the pose");
    d.Integer("task_utime", &task_utime, 0, kMost, "Of the task");
    d.Text("source", &source, "Who wants it");
    d.Text("kind", &kind, "Of the task");
    d.Number("max_speed", &max_speed, kNotNegative, "m/s");
    d.Integer("num_reached", &num_reached, 0, 10'000, "Way-points");
    d.Numbers("waypoints", &waypoints, -1, "x, y, has heading, heading; ...");
  }
};

}  // namespace

std::optional<TaskProgress> LoadTaskFile(const std::string& path) {
  std::error_code error;
  if (!std::filesystem::exists(path, error)) {
    if (error) throw InputError(path + ": " + error.message());
    return std::nullopt;
  }
  Contents contents;
  LoadConfigurationFile(path, [&](Describer& d) { contents.Describe(d); });
  if (contents.kind == "none") return std::nullopt;
  const std::vector<double>& numbers = contents.waypoints;
  if (numbers.size() % 4 != 0) {
    throw InputError(path + ": waypoints: " + std::to_string(numbers.size()) +
                     " numbers are no fours");
  }
  task_t message;
  message.utime = contents.task_utime;
  message.source = contents.source;
  message.kind = contents.kind;
  message.max_speed = contents.max_speed;
  for (std::size_t i = 0; i < numbers.size(); i += 4) {
    waypoint_t waypoint;
    waypoint.x = numbers[i];
    waypoint.y = numbers[i + 1];
    waypoint.has_heading = numbers[i + 2] != 0.0 ? 1 : 0;
    waypoint.heading = numbers[i + 3];
    message.waypoints.push_back(waypoint);
  }
  message.num_waypoints = static_cast<std::int32_t>(message.waypoints.size());
  std::string reason;
  const auto task = TaskFromMessage(message, &reason);
  if (!task) throw InputError(path + ": " + reason);
  return TaskProgress{*task,
                      TimeFromMicroseconds(contents.utime),
                      static_cast<int>(contents.num_reached)};
}

std::string TextOfTask(const std::optional<TaskProgress>& progress) {
  Contents contents;
  if (progress) {
    const task_t message = ToMessage(progress->task, 0);
    contents.utime = Microseconds(progress->time);
    contents.task_utime = message.utime;
    contents.source = message.source;
    contents.kind = message.kind;
    contents.max_speed = message.max_speed;
    contents.num_reached = progress->num_reached;
    for (const waypoint_t& w : message.waypoints) {
      contents.waypoints.insert(
          contents.waypoints.end(),
          {w.x, w.y, static_cast<double>(w.has_heading), w.heading});
    }
  }
  return "# A task under way.\n" +
         PrintConfiguration([&](Describer& d) { contents.Describe(d); });
}

}  // namespace waymark
