#include "processes/teleop/teleop_process.h"

#include "estimation/geometry/angle.h"
#include "processes/convert/message_check.h"
#include "processes/support/channels.h"

#include <waymark/stop_t.hpp>

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <vector>

namespace waymark {
namespace {

// A stroke is answered within one period.
constexpr Duration kPeriod{20'000};
constexpr int kTicksPerRequest = 2;  // 25 Hz.
constexpr int kTicksPerDrawing = 5;
// All that is shown comes at 10 Hz at least; what is older says nothing.
constexpr Duration kTimeout{500'000};

constexpr std::string_view kHelp =
    "arrows or w a s d: drive   q e: on a curve   + -: faster, slower\r\n"
    "space: STOP   g: let go   Ctrl-C: end\r\n";

// Texts of others on a terminal, as far as they fit.
std::string Line(const std::string& text, int num_columns) {
  std::string line =
      text.substr(0, static_cast<std::size_t>(std::max(num_columns - 1, 10)));
  std::replace_if(
      line.begin(), line.end(), [](char c) { return c < ' ' || c > '~'; }, '?');
  return line + "\x1b[K\r\n";
}

}  // namespace

TeleopProcess::TeleopProcess(const Config& config,
                             Bus* bus,
                             int input_fd,
                             int output_fd)
    : bus_(bus), terminal_(input_fd, output_fd), keys_(config) {
  bus->Advertise<velocity_t>(kMotionRequest, kName);
  bus->Advertise<stop_t>(kStop, kName);
  bus->Subscribe<velocity_t>(
      kMotionCommand, Keep::Latest(), [this](const velocity_t& m, Time) {
        command_ = m;
        command_arrived_ = bus_->now();
      });
  bus->Subscribe<pose_t>(kPose, Keep::Latest(), [this](const pose_t& m, Time) {
    pose_ = m;
    pose_arrived_ = bus_->now();
  });
  bus->Subscribe<base_status_t>(
      kBase, Keep::Latest(), [this](const base_status_t& m, Time) {
        std::string reason;
        if (!CheckTime("utime", m.utime, &reason)) {
          bus_->ReportBad(kBase, Bad::kContent, reason);
          return;
        }
        base_ = m;
        base_arrived_ = bus_->now();
      });
  bus->Every(kPeriod, [this](Time now) { OnTimer(now); });
  terminal_.Write(kHelp);
}

Time TeleopProcess::RobotTime(Time now) const {
  if (!base_ || now - base_arrived_ > kTimeout) return now;
  return TimeFromMicroseconds(base_->utime) + (now - base_arrived_);
}

void TeleopProcess::OnTimer(Time now) {
  const std::optional<KeyEvent> event = keys_.Type(now, terminal_.Read());
  if (event) SendStop(now, *event == KeyEvent::kStop);
  const Velocity wanted = keys_.At(now);
  // What is new does not wait for its turn.
  if (wanted != asked_ || num_ticks_ % kTicksPerRequest == 0) Ask(now, wanted);
  if (num_ticks_ % kTicksPerDrawing == 0) Draw(now);
  ++num_ticks_;
}

void TeleopProcess::Ask(Time now, const Velocity& velocity) {
  asked_ = velocity;
  velocity_t message;
  message.utime = Microseconds(RobotTime(now));
  message.seq = request_seq_++;
  message.source = kName;
  message.forward = velocity.forward;
  message.turn_rate = velocity.turn_rate;
  if (velocity.is_zero()) message.reason = "no key";
  bus_->Publish(kMotionRequest, message);
}

void TeleopProcess::SendStop(Time now, bool is_stopped) {
  stop_t message;
  message.utime = Microseconds(RobotTime(now));
  message.seq = stop_seq_++;
  message.source = kName;
  message.is_stopped = is_stopped ? 1 : 0;
  message.reason = is_stopped ? "space" : "g";
  bus_->Publish(kStop, message);
}

void TeleopProcess::Draw(Time now) {
  const auto speeds = [](double forward, double turn_rate) {
    return fmt::format(
        "{:5.2f} m/s {:6.1f} deg/s", forward, DegreesFromRadians(turn_rate));
  };
  const auto is_new = [now](Time arrived) { return now - arrived <= kTimeout; };
  std::string allowed = "no MOTION_COMMAND: does collision_guard run?";
  if (command_ && is_new(command_arrived_)) {
    allowed = fmt::format("{}   {}",
                          speeds(command_->forward, command_->turn_rate),
                          command_->reason);
  }
  std::string base = "no BASE";
  if (base_ && is_new(base_arrived_)) {
    base = fmt::format(
        "{} contacts{}{}{}",
        base_->num_contacts,
        base_->is_bumper_left != 0 ? ", left" : "",
        base_->is_bumper_right != 0 ? ", right" : "",
        base_->is_command_current != 0 ? "" : ", stands without command");
  }
  std::string pose = "no POSE";
  if (pose_ && is_new(pose_arrived_)) {
    const auto& [x, y, heading] = pose_->pose_W;
    pose = pose_->is_known == 0
               ? "unknown: " + pose_->reason
               : fmt::format("x {:.2f} m  y {:.2f} m  {:.0f} deg",
                             x,
                             y,
                             DegreesFromRadians(heading));
  }
  const std::vector<std::string> lines{
      fmt::format("asked    {}   speed {:.0f} %",
                  speeds(asked_.forward, asked_.turn_rate),
                  100.0 * keys_.share()),
      "allowed  " + allowed,
      "base     " + base,
      "pose     " + pose};
  std::string text;
  for (const std::string& line : lines) {
    text += Line(line, terminal_.num_columns());
  }
  if (text == shown_) return;
  // Over what was there before.
  if (!shown_.empty()) {
    terminal_.Write("\x1b[" + std::to_string(lines.size()) + "A");
  }
  terminal_.Write(text);
  shown_ = std::move(text);
}

void TeleopProcess::Finish() {
  Ask(bus_->now(), {});
}

}  // namespace waymark
