#include "processes/tools/task/task_tool.h"

#include "estimation/base/input_error.h"
#include "estimation/geometry/angle.h"
#include "planner/control/corridor_way.h"
#include "processes/convert/corridor_file.h"
#include "processes/convert/task_convert.h"
#include "processes/support/channels.h"
#include "processes/support/decode.h"
#include "processes/support/lcm_url.h"
#include "processes/support/run_tool.h"
#include "processes/tools/task/corridor_watch.h"

#include <waymark/corridor_pose_t.hpp>
#include <waymark/pose_t.hpp>
#include <waymark/stop_t.hpp>
#include <waymark/task_status_t.hpp>
#include <waymark/task_t.hpp>
#include <waymark/truth_t.hpp>
#include <waymark/velocity_t.hpp>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <lcm/lcm-cpp.hpp>

#include <algorithm>
#include <charconv>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace waymark {
namespace {

using Steady = std::chrono::steady_clock;
using std::chrono::milliseconds;

constexpr char kName[] = "waymark-task";
// What may have been lost, or come before its receiver, is sent again.
constexpr milliseconds kRepeat{500};
constexpr milliseconds kLook{50};  // How late an answer may be seen.
// A line at least so often while the robot drives.
constexpr milliseconds kLinePeriod{2000};
// A follower that was restarted is idle until its first pose.
constexpr milliseconds kIdleFor{2000};

struct TaskOptions {
  std::string url;
  double timeout_s = 5.0;
  std::vector<std::string> places;
  std::string corridors;
  std::string corridor;  // Of them; empty: by `start`, or the first.
  std::string start;     // Where the robot stands; empty: anywhere.
  bool check = false;
  CorridorWayOptions way;
  double speed = 0.0;
  bool follow = false;
};

std::int64_t WallUtime() {
  return std::chrono::duration_cast<Duration>(
             std::chrono::system_clock::now().time_since_epoch())
      .count();
}

// "x,y" or "x,y,heading in degrees".
Waypoint WaypointFromText(const std::string& text) {
  std::vector<double> numbers;
  const char* at = text.data();
  const char* end = at + text.size();
  bool is_good = true;
  while (is_good) {
    double value = 0.0;
    const auto [next, error] = std::from_chars(at, end, value);
    // Beyond this nothing is a place in a building.
    is_good = error == std::errc() && std::abs(value) <= 1e6;
    numbers.push_back(value);
    at = next;
    if (at == end || *at != ',') break;
    ++at;
  }
  if (!is_good || at != end || numbers.size() < 2 || numbers.size() > 3) {
    throw InputError("'" + text +
                     "' is no place: x,y or x,y,heading (m, m, deg), each "
                     "within +-1e6");
  }
  Waypoint waypoint{{numbers[0], numbers[1]}, {}};
  if (numbers.size() == 3) {
    waypoint.heading = WrapAngle(RadiansFromDegrees(numbers[2]));
  }
  return waypoint;
}

std::vector<Waypoint> PlacesOf(const TaskOptions& options) {
  std::vector<Waypoint> waypoints;
  for (const std::string& place : options.places) {
    waypoints.push_back(WaypointFromText(place));
  }
  return waypoints;
}

bool IsIn(const CorridorGeometry& corridor, const Eigen::Vector2d& p_W) {
  const Eigen::Vector2d p_L = Inverse(corridor.X_WL) * p_W;
  return p_L.x() >= corridor.x_min && p_L.x() <= corridor.x_max &&
         (!corridor.width || std::abs(p_L.y()) <= 0.5 * *corridor.width);
}

CorridorGeometry CorridorOf(const TaskOptions& options) {
  std::vector<CorridorGeometry> corridors =
      LoadCorridorFile(FindCorridorFile(options.corridors));
  std::string known;
  for (const CorridorGeometry& corridor : corridors) {
    known += (known.empty() ? "" : ", ") + corridor.name;
  }
  if (!options.corridor.empty()) {
    std::erase_if(corridors, [&](const CorridorGeometry& corridor) {
      return corridor.name != options.corridor;
    });
    if (corridors.empty()) {
      throw InputError("--corridor: no '" + options.corridor + "' in " +
                       options.corridors + ", which has " + known);
    }
  }
  if (!options.start.empty()) {
    const Eigen::Vector2d start = WaypointFromText(options.start).p_W;
    std::erase_if(corridors, [&](const CorridorGeometry& corridor) {
      return !IsIn(corridor, start);
    });
    if (corridors.empty()) {
      throw InputError(
          "--start: the robot at " + options.start + " is not in " +
          (options.corridor.empty() ? "any of " + known : options.corridor));
    }
  }
  return corridors.front();
}

// Throws InputError where the way leaves the corridor.
void CheckWay(const CorridorWayOptions& way, const CorridorGeometry& corridor) {
  const double end = way.begin + way.length;
  if (way.begin < corridor.x_min || end > corridor.x_max) {
    throw InputError(fmt::format(
        "--begin, --length: the way is from {:g} to {:g} m, {} from {:g} to "
        "{:g}",
        way.begin,
        end,
        corridor.name,
        corridor.x_min,
        corridor.x_max));
  }
  if (corridor.width && way.zigzag >= 0.5 * *corridor.width) {
    throw InputError(
        fmt::format("--zigzag: {:g} m to both sides, {} is {:g} m "
                    "wide",
                    way.zigzag,
                    corridor.name,
                    *corridor.width));
  }
}

// In W.
std::vector<Waypoint> CorridorWaypoints(const TaskOptions& options) {
  const CorridorGeometry corridor = CorridorOf(options);
  CheckWay(options.way, corridor);
  std::vector<Waypoint> waypoints;
  for (const Eigen::Vector2d& p_L : CorridorWay(options.way)) {
    waypoints.push_back({corridor.X_WL * p_L, {}});
  }
  return waypoints;
}

// Text from the bus on a terminal.
std::string Printable(std::string text) {
  std::replace_if(
      text.begin(), text.end(), [](char c) { return c < ' ' || c > '~'; }, '?');
  return text;
}

// Sends something until it is answered, and listens.
class Talk {
 public:
  explicit Talk(const TaskOptions& options) : timeout_s_(options.timeout_s) {
    const std::string url = WithGrantedBuffer(LcmUrl(options.url));
    CheckLcmReachable(url);
    lcm_ = std::make_unique<lcm::LCM>(url);
    if (!lcm_->good()) throw InputError("LCM cannot be created with " + url);
  }

  template <typename M>
  void Listen(std::string_view channel, std::function<void(const M&)> handler) {
    handlers_.push_back([handler](std::span<const std::uint8_t> data) {
      if (const auto message = DecodeMessage<M>(data)) handler(*message);
    });
    lcm_->subscribe(std::string(channel), &Talk::OnMessage, this);
    channels_.emplace_back(channel);
  }

  template <typename M>
  void Send(std::string_view channel, const M& message) {
    lcm_->publish(std::string(channel), &message);
  }

  // Handles what comes for a moment.
  void Look() {
    if (lcm_->handleTimeout(static_cast<int>(kLook.count())) < 0) {
      throw std::runtime_error("LCM stopped working");
    }
  }

  // Sends again and again until `is_answered`; false once the time has passed.
  template <typename M>
  bool SendUntil(std::string_view channel,
                 const M& message,
                 const std::function<bool()>& is_answered) {
    const auto end =
        Steady::now() + std::chrono::duration_cast<Steady::duration>(
                            std::chrono::duration<double>(timeout_s_));
    Steady::time_point next = Steady::now();
    while (!is_answered()) {
      if (Steady::now() >= end) return false;
      if (Steady::now() >= next) {
        Send(channel, message);
        next = Steady::now() + kRepeat;
      }
      Look();
    }
    return true;
  }

 private:
  void OnMessage(const lcm::ReceiveBuffer* buffer, const std::string& channel) {
    for (std::size_t i = 0; i < channels_.size(); ++i) {
      if (channels_[i] != channel) continue;
      handlers_[i](
          {static_cast<const std::uint8_t*>(buffer->data), buffer->data_size});
    }
  }

  double timeout_s_;
  std::unique_ptr<lcm::LCM> lcm_;
  std::vector<std::string> channels_;
  std::vector<std::function<void(std::span<const std::uint8_t>)>> handlers_;
};

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
  Talk talk(options);
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
  Talk talk(options);
  // Who says what since it was sent; 0: nothing is under way.
  std::map<std::string, std::int64_t> tasks;
  talk.Listen<task_status_t>(kTaskStatus, [&](const task_status_t& m) {
    tasks[m.source] = m.task_utime;
  });
  talk.Send(kTask, ToMessage(task, 0));
  const auto sent = Steady::now();
  const auto is_answered = [&] {
    return Steady::now() - sent > kRepeat && !tasks.empty() &&
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
  Talk talk(options);
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
  command
      ->add_option("CORRIDOR",
                   options->corridors,
                   "Corridor file, or one that comes with Waymark")
      ->required();
  command->add_option("--corridor",
                      options->corridor,
                      "Name of the one in the file (default: the one with "
                      "--start, or the first)");
  command->add_option("--start",
                      options->start,
                      "X,Y in m: where the robot stands, which must be in it");
  command->add_flag(
      "--check", options->check, "Say whether that can be driven, and end");
  CorridorWayOptions* way = &options->way;
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
              const auto waypoints = CorridorWaypoints(*options);
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
