#include "processes/tools/task/task_tool.h"

#include "estimation/base/input_error.h"
#include "processes/convert/task_convert.h"
#include "processes/support/channels.h"
#include "processes/support/run_tool.h"
#include "processes/tools/task/corridor_task.h"
#include "processes/tools/task/corridor_watch.h"
#include "processes/tools/task/talk.h"
#include "processes/tools/task/task_places.h"

#include <waymark/corridor_pose_t.hpp>
#include <waymark/pose_t.hpp>
#include <waymark/stop_t.hpp>
#include <waymark/task_status_t.hpp>
#include <waymark/task_t.hpp>
#include <waymark/truth_t.hpp>
#include <waymark/velocity_t.hpp>

#include <CLI/CLI.hpp>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace waymark {
namespace {

using Steady = std::chrono::steady_clock;
using std::chrono::milliseconds;

constexpr char kName[] = "waymark-task";
// A line at least so often while the robot drives.
constexpr milliseconds kLinePeriod{2000};
// A follower that was restarted is idle until its first pose.
constexpr milliseconds kIdleFor{2000};

struct TaskOptions {
  std::string url;
  double timeout_s = 5.0;
  std::vector<std::string> places;
  CorridorTask corridor;
  bool check = false;
  double speed = 0.0;
  bool follow = false;
};

std::int64_t WallUtime() {
  return std::chrono::duration_cast<Duration>(
             std::chrono::system_clock::now().time_since_epoch())
      .count();
}

std::vector<Waypoint> PlacesOf(const TaskOptions& options) {
  std::vector<Waypoint> waypoints;
  for (const std::string& place : options.places) {
    waypoints.push_back(WaypointFromText(place));
  }
  return waypoints;
}

// Text from the bus on a terminal.
std::string Printable(std::string text) {
  std::replace_if(
      text.begin(), text.end(), [](char c) { return c < ' ' || c > '~'; }, '?');
  return text;
}

int Complain(const std::string& text) {
  std::fprintf(stderr, "%s: %s\n", kName, text.c_str());
  return 1;
}

// What is known of one task.
class Progress {
 public:
  explicit Progress(std::int64_t task_utime) : task_utime_(task_utime) {}

  void OnStatus(const task_status_t& status) {
    if (status.task_utime == task_utime_) {
      status_ = status;
      heard_ = Steady::now();
    } else if (status_ && status.source == status_->source &&
               Steady::now() - heard_ > kIdleFor) {
      is_given_up_ = true;
    }
  }
  [[nodiscard]] bool is_taken() const { return status_.has_value(); }
  [[nodiscard]] bool is_given_up() const { return is_given_up_; }
  [[nodiscard]] const task_status_t& status() const { return *status_; }
  [[nodiscard]] Steady::duration silence() const {
    return Steady::now() - heard_;
  }

  // A line where there is news, with what is seen of a corridor.
  void Show(CorridorWatch* watch) {
    const std::string news = status_->state + status_->reason.substr(0, 8) +
                             std::to_string(status_->num_reached);
    if (news == shown_ && Steady::now() - shown_at_ < kLinePeriod) return;
    shown_ = news;
    shown_at_ = Steady::now();
    const std::string seen = watch->News();
    std::printf("%s: %d of %d way-points, %.1f m left%s%s%s%s\n",
                Printable(status_->state).c_str(),
                status_->num_reached,
                status_->num_waypoints,
                status_->distance_left,
                status_->reason.empty() ? "" : ", ",
                Printable(status_->reason).c_str(),
                seen.empty() ? "" : "; ",
                seen.c_str());
    std::fflush(stdout);
  }

 private:
  std::int64_t task_utime_;
  std::optional<task_status_t> status_;
  Steady::time_point heard_;
  bool is_given_up_ = false;
  std::string shown_;
  Steady::time_point shown_at_;
};

int SendTask(const std::string& kind,
             const std::vector<Waypoint>& waypoints,
             const TaskOptions& options) {
  Task task;
  task.time = TimeFromMicroseconds(WallUtime());
  task.source = kName;
  task.kind = kind;
  task.max_speed = options.speed;
  task.waypoints = waypoints;
  Talk talk(options.url, options.timeout_s);
  Progress progress(Microseconds(task.time));
  CorridorWatch watch;
  talk.Listen<task_status_t>(
      kTaskStatus, [&](const task_status_t& m) { progress.OnStatus(m); });
  talk.Listen<corridor_pose_t>(
      kCorridorPose, [&](const corridor_pose_t& m) { watch.OnAnswer(m); });
  talk.Listen<pose_t>(kPose, [&](const pose_t& m) { watch.OnPose(m); });
  talk.Listen<truth_t>(kTruth, [&](const truth_t& m) { watch.OnTruth(m); });
  if (!talk.SendUntil(
          kTask, ToMessage(task, 0), [&] { return progress.is_taken(); })) {
    return Complain(
        "nobody has taken the task: does " +
        std::string(kind == "tour" ? "tour_driver" : "path_follower") +
        " run, and has it a pose?");
  }
  progress.Show(&watch);
  if (!options.follow) return 0;
  while (true) {
    talk.Look();
    progress.Show(&watch);
    if (progress.status().state == "done") return 0;
    if (progress.status().state == "failed") {
      return Complain("failed: " + Printable(progress.status().reason));
    }
    if (progress.is_given_up()) return Complain("the task was given up");
    if (progress.silence() > std::chrono::duration<double>(options.timeout_s)) {
      return Complain("no TASK_STATUS any longer");
    }
  }
}

int Cancel(const TaskOptions& options) {
  Task task;
  task.time = TimeFromMicroseconds(WallUtime());
  task.source = kName;
  task.kind = "none";
  Talk talk(options.url, options.timeout_s);
  // Who says what since it was sent; 0: nothing is under way.
  std::map<std::string, std::int64_t> tasks;
  talk.Listen<task_status_t>(kTaskStatus, [&](const task_status_t& m) {
    tasks[m.source] = m.task_utime;
  });
  talk.Send(kTask, ToMessage(task, 0));
  const auto sent = Steady::now();
  const auto is_answered = [&] {
    return Steady::now() - sent > Talk::kRepeat && !tasks.empty() &&
           std::all_of(tasks.begin(), tasks.end(), [](const auto& entry) {
             return entry.second == 0;
           });
  };
  if (talk.SendUntil(kTask, ToMessage(task, 0), is_answered)) return 0;
  return Complain("nobody has answered; it was sent all the same");
}

int SendStop(bool is_stopped, const TaskOptions& options) {
  stop_t stop;
  stop.utime = WallUtime();
  stop.source = kName;
  stop.is_stopped = is_stopped ? 1 : 0;
  Talk talk(options.url, options.timeout_s);
  bool is_answered = false;
  talk.Listen<velocity_t>(kMotionCommand, [&](const velocity_t& m) {
    const bool says_stopped = m.reason.rfind("stopped", 0) == 0;
    is_answered = says_stopped == is_stopped;
  });
  // The first one goes out before any answer counts.
  talk.Send(kStop, stop);
  if (talk.SendUntil(kStop, stop, [&] { return is_answered; })) {
    std::printf("%s\n", is_stopped ? "stopped" : "let go");
    return 0;
  }
  return Complain("collision_guard has not answered; it was sent all the same");
}

void AddCommonOptions(CLI::App* command, TaskOptions* options) {
  command->add_option(
      "--lcm-url", options->url, "LCM network (else LCM_DEFAULT_URL)");
  RequireRange(command->add_option("--timeout",
                                   options->timeout_s,
                                   "Give up after so long without answer, s"),
               0.0,
               1e6)
      ->capture_default_str();
}

void AddWayOptions(CLI::App* command, TaskOptions* options) {
  CorridorTask* task = &options->corridor;
  command
      ->add_option("CORRIDOR",
                   task->corridors,
                   "Corridor file, or one that comes with Waymark")
      ->required();
  command->add_option("--corridor",
                      task->corridor,
                      "Name of the one in the file (default: the one with "
                      "--start, or the first)");
  command->add_option("--start",
                      task->start,
                      "X,Y in m: where the robot stands, which must be in it");
  command->add_flag(
      "--check", options->check, "Say whether that can be driven, and end");
  CorridorWayOptions* way = &task->way;
  const auto add =
      [&](const char* name, double* value, double from, const char* help) {
        RequireRange(command->add_option(name, *value, help), from, 1000.0)
            ->capture_default_str();
      };
  add("--begin", &way->begin, -1000.0, "Along the axis, m");
  add("--length", &way->length, 0.1, "From there, one way, m");
  command->add_option("--legs", way->num_legs, "So often, to and fro")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  add("--zigzag", &way->zigzag, 0.0, "To both sides of the axis, m");
  add("--zigzag-step", &way->zigzag_step, 0.1, "Along it, m");
}

}  // namespace

int RunTaskTool(int argc, char** argv) {
  const auto options = std::make_shared<TaskOptions>();
  return RunTool(
      argc,
      argv,
      kName,
      "Tells a robot what to do.",
      [options](CLI::App* app, int* exit_code) {
        app->require_subcommand(1);
        const auto add = [&](const char* name,
                             const char* help,
                             const std::function<int()>& run) {
          CLI::App* command = app->add_subcommand(name, help);
          AddCommonOptions(command, options.get());
          command->callback([run, exit_code] { *exit_code = run(); });
          return command;
        };
        const auto add_drive = [&](CLI::App* command) {
          RequireRange(
              command->add_option(
                  "--speed", options->speed, "At most, m/s (0: its own)"),
              0.0,
              100.0);
          command->add_flag("--follow",
                            options->follow,
                            "Show its progress until it is done");
        };
        const auto add_places = [&](const char* name, const char* help) {
          CLI::App* command = add(name, help, [options, kind = name] {
            return SendTask(kind, PlacesOf(*options), *options);
          });
          command
              ->add_option("PLACE",
                           options->places,
                           "X,Y or X,Y,HEADING in m, m and degrees")
              ->required();
          add_drive(command);
        };
        add_places("waypoints", "Drives to places in order, on POSE");
        add_places("tour", "The same on TRUTH, for teaching");
        CLI::App* corridor = add(
            "corridor", "Drives to and fro in a corridor, on POSE", [options] {
              const auto waypoints = CorridorWaypoints(options->corridor);
              if (options->check) return 0;
              return SendTask("waypoints", waypoints, *options);
            });
        AddWayOptions(corridor, options.get());
        add_drive(corridor);
        add("cancel", "Gives up what is under way", [options] {
          return Cancel(*options);
        });
        add("stop", "Stops the robot until someone lets go", [options] {
          return SendStop(true, *options);
        });
        add("go", "Lets go of a stop", [options] {
          return SendStop(false, *options);
        });
      });
}

}  // namespace waymark
