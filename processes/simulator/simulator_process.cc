#include "processes/simulator/simulator_process.h"

#include "drivers/simulator/build_scene.h"
#include "drivers/simulator/mesh_outline.h"
#include "estimation/base/input_error.h"
#include "estimation/geometry/angle.h"
#include "processes/convert/motion_convert.h"
#include "processes/convert/world_file.h"
#include "processes/simulator/robot_state_file.h"
#include "processes/simulator/simulator_messages.h"
#include "processes/simulator/start_place.h"
#include "processes/support/channels.h"

#include <waymark/base_status_t.hpp>
#include <waymark/encoders_t.hpp>
#include <waymark/planar_lidar_t.hpp>
#include <waymark/truth_t.hpp>

#include <spdlog/fmt/fmt.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <variant>

namespace waymark {
namespace {

// Half the height of what a planar sensor sees, m: a beam has a width.
constexpr double kHalfPlane = 0.01;
constexpr Duration kInfoPeriod = std::chrono::seconds(1);
constexpr Duration kSavePeriod = std::chrono::seconds(1);
// Simulated time that may pass before a saved state is on disk, where it goes
// faster than the clock: the fastest answers, and a slow disk.
constexpr Duration kSaveLead = std::chrono::seconds(60);
// What has happened is a fault for so long: in several STATUS.
constexpr Duration kRecent = std::chrono::seconds(5);
// Time stamps so far ahead of the clock are no matter of a restart: the clock
// was wrong once, or simulated time was faster.
constexpr Duration kAhead = std::chrono::seconds(3);
// Live, a reading is sent so long after its own time: more than a timer is
// early or late, so that each tick has just one.
constexpr Duration kTimerSlack = std::chrono::milliseconds(2);
// Live, an image does not wait for the wheels' next tick but this long at most.
constexpr Duration kImageTick = std::chrono::milliseconds(4);

std::optional<RangeSensorOptions> RangeOptions(const SimulatorConfig& config) {
  if (config.ranges == RangeKind::kNone) return std::nullopt;
  RangeSensorOptions options = config.ranges == RangeKind::kSonar
                                   ? RangeSensorOptions::SonarRing()
                                   : RangeSensorOptions::Lidar();
  options.rate_hz = config.range_rate_hz;
  options.sigma = config.range_noise;
  return options;
}

// The walls are there for the robot, their looks for cameras alone.
SceneLooks LooksFor(const SimulatorConfig& config) {
  return config.camera.name.empty() && config.second_camera.name.empty()
             ? SceneLooks::kPlain
             : SceneLooks::kDrawn;
}

// How often the clock is looked at: once for each reading of the encoders.
Duration TickOf(const SimulatorConfig& config) {
  const double speed = config.pace == Pace::kRealTime ? config.speed : 1.0;
  return DurationFromSeconds(1.0 / (config.encoder_rate_hz * speed));
}

}  // namespace

SimulatorProcess::SimulatorProcess(const Config& config, Bus* bus)
    : config_(config),
      bus_(bus),
      world_(LoadWorldFile(FindWorldFile(config.world))),
      scene_(BuildScene(world_, LooksFor(config))),
      area_(world_, scene_.mesh, config.robot.height),
      people_(world_,
              WalkArea(world_, scene_.mesh, kPersonHeight),
              PeopleOptions{config.robot.radius}),
      range_options_(RangeOptions(config)),
      saver_(config.state_file, bus->is_offline()) {
  if (config.range_height > 0.0) {
    seen_.emplace(OutlineOfMesh(scene_.mesh,
                                {.low = config.range_height - kHalfPlane,
                                 .high = config.range_height + kHalfPlane}));
  }
  start_.X_WR = StartPose();
  if (const std::string fault = FaultOf(start_.X_WR); !fault.empty()) {
    throw InputError(world_.source + ": start: " + fault);
  }
  if (!config_.state_file.empty()) LoadState();
  if (!bus->is_offline()) {
    spdlog::info("in {}: a robot at x {:.2f} m, y {:.2f} m, {:.0f} deg",
                 world_.source,
                 start_.X_WR.x,
                 start_.X_WR.y,
                 DegreesFromRadians(start_.X_WR.heading));
  }
  AddCamera(config_.camera);
  AddCamera(config_.second_camera);
  scene_ = Scene{};  // All that draws it has its own copy.

  bus->Advertise<encoders_t>(kEncoders);
  bus->Advertise<base_status_t>(kBase);
  bus->Advertise<truth_t>(kTruth);
  if (range_options_) bus->Advertise<planar_lidar_t>(kRanges);
  // Stepped, no other command may displace the answer.
  bus->Subscribe<velocity_t>(
      kMotionCommand,
      config.pace == Pace::kStepped ? Keep::All() : Keep::Latest(),
      [this](const velocity_t& m, Time t) { OnCommand(m, t); });
  bus->Subscribe<pan_tilt_t>(kPanTiltCommand,
                             Keep::Latest(),
                             [this](const pan_tilt_t& m, Time) { OnHead(m); });
  bus->Every(TickOf(config_), [this](Time now) {
    config_.pace == Pace::kRealTime ? OnTick(now) : OnStepTick(now);
    ShowFault(now);
  });
  if (!bus->is_offline() && config_.pace == Pace::kRealTime &&
      !cameras_.empty()) {
    bus->Every(kImageTick, [this](Time now) { OnImageTick(now); });
  }
}

Pose2 SimulatorProcess::StartPose() const {
  Pose2 X_WR;
  if (!config_.start.empty()) {
    X_WR = {config_.start[0],
            config_.start[1],
            WrapAngle(RadiansFromDegrees(config_.start[2]))};
  } else if (!world_.starts.empty()) {
    X_WR = world_.starts.front().X_WR;
  }
  return X_WR;
}

std::string SimulatorProcess::FaultOf(const Pose2& X_WR) const {
  return FaultOfStart(X_WR, config_.robot.radius, area_, world_, people_);
}

void SimulatorProcess::LoadState() {
  const auto saved = LoadRobotState(config_.state_file);
  if (!saved) return;
  saved_time_ = saved->time;
  if (saved->world != world_.source) return;
  // No end: nobody would start it again, and it would end like this each time.
  const std::string fault = FaultOf(saved->snapshot.X_WR);
  if (fault.empty()) {
    start_ = saved->snapshot;
    return;
  }
  spdlog::warn(
      "{}: pose: {}: lost, with the ticks of the wheels; begins at the start",
      config_.state_file,
      fault);
}

void SimulatorProcess::AddCamera(const SimulatedCameraConfig& config) {
  if (config.name.empty()) return;
  if (!renderer_) {
    RendererOptions options;
    options.num_threads = static_cast<int>(config_.num_threads);
    options.shader.light_map.cell_size = config_.light_cell;
    spdlog::info("computing the light of {}, {} triangles",
                 world_.source,
                 scene_.mesh.triangles.size());
    renderer_ = std::make_unique<Renderer>(scene_, options);
  }
  cameras_.emplace_back(config,
                        renderer_.get(),
                        static_cast<std::uint64_t>(config_.seed),
                        bus_,
                        IsLive());
}

Simulation SimulatorProcess::MakeSimulation(Time start) const {
  SimulationOptions options;
  options.robot = config_.robot;
  options.encoder_rate_hz = config_.encoder_rate_hz;
  options.truth_rate_hz = config_.encoder_rate_hz;
  options.status_rate_hz = config_.status_rate_hz;
  options.ranges = range_options_;
  for (const CameraFeed& camera : cameras_) {
    options.cameras.push_back(camera.timing());
  }
  options.person_radius = kPersonRadius;
  options.start_time = start;
  options.seed = static_cast<std::uint64_t>(config_.seed);
  SimulationWorld world;
  world.map = &area_.map();
  if (seen_) world.seen = &*seen_;
  world.people = [this](double seconds,
                        const Pose2& X_WR,
                        std::span<const PersonState> states) {
    return people_.PosesAt(seconds, X_WR, states);
  };
  world.meet = [this](double seconds,
                      double dt,
                      const Pose2& X_WR,
                      std::vector<PersonState>* states) {
    people_.Meet(seconds, dt, X_WR, states);
  };
  return Simulation(options, world, start_);
}

// ---- time ------------------------------------------------------------------

bool SimulatorProcess::IsLive() const {
  return config_.pace == Pace::kRealTime && !bus_->is_offline();
}

Time SimulatorProcess::StartTime(Time now) const {
  const Time start = IsLive() ? now - kTimerSlack : now;
  if (!saved_time_ || *saved_time_ < start) return start;
  spdlog::info("goes on {:.1f} s ahead of the clock, where it was",
               Seconds(*saved_time_ - now));
  return *saved_time_ + Duration(1);
}

void SimulatorProcess::OnTick(Time now) {
  if (!simulation_) {
    const Time start = StartTime(now);
    simulation_.emplace(MakeSimulation(start));
    clock_.emplace(config_.speed,
                   TickOf(config_),
                   now,
                   bus_->is_offline() ? start : start + kTimerSlack);
  }
  const Duration lost = clock_->lost();
  const Time simulated = clock_->At(now);
  if (clock_->lost() > lost) lost_time_ = now;
  ticked_at_ = now;
  AdvanceTo(simulated);
}

void SimulatorProcess::OnImageTick(Time now) {
  if (!simulation_) return;
  const Time simulated =
      simulation_->now() +
      DurationFromSeconds(config_.speed * Seconds(now - ticked_at_));
  for (CameraFeed& camera : cameras_) camera.PublishImages(simulated);
}

void SimulatorProcess::OnStepTick(Time now) {
  if (!simulation_) {
    simulation_.emplace(MakeSimulation(StartTime(now)));
    Step(now);
    return;
  }
  if (Seconds(now - asked_at_) < config_.answer_timeout_s) return;
  ++num_unanswered_;
  is_unanswered_ = true;
  Step(now);
}

void SimulatorProcess::Step(Time now) {
  // Set first: on a bus in the same thread the answer may come at once.
  asked_at_ = now;
  unanswered_ = simulation_->NextEncoderTime();
  AdvanceTo(*unanswered_);
}

void SimulatorProcess::OnCommand(const velocity_t& message, Time t) {
  std::string reason;
  if (!CheckVelocity(message, &reason)) {
    bus_->ReportBad(kMotionCommand, Bad::kContent, reason);
    return;
  }
  if (!simulation_) return;
  simulation_->Command(message.forward, message.turn_rate);
  // All others are obeyed, too, but answer nothing: late ones, those of who
  // goes by another clock, and what the guard sends because nobody asks.
  const bool is_answer = unanswered_ == t && !message.source.empty();
  if (config_.pace != Pace::kStepped || !is_answer) return;
  is_unanswered_ = false;
  Step(bus_->now());
}

void SimulatorProcess::OnHead(const pan_tilt_t& message) {
  if (!std::isfinite(message.pan) || !std::isfinite(message.tilt)) {
    bus_->ReportBad(
        kPanTiltCommand, Bad::kContent, "pan and tilt must be finite");
    return;
  }
  if (simulation_) simulation_->CommandHead({message.pan, message.tilt});
}

void SimulatorProcess::AdvanceTo(Time simulated) {
  Publish(simulation_->AdvanceTo(std::max(simulated, simulation_->now())));
  for (CameraFeed& camera : cameras_) camera.PublishImages(simulated);
  PublishCameraInfo(simulated);
  if (!save_time_ || simulated - *save_time_ >= kSavePeriod) {
    save_time_ = simulated;
    SaveState(SaveLead());
  }
}

void SimulatorProcess::SaveState(Duration lead) {
  if (!simulation_) return;
  saver_.Save(TextOfRobotState(
      {world_.source, simulation_->Snapshot(), simulation_->now() + lead}));
}

Duration SimulatorProcess::SaveLead() const {
  // With the clock, a restart comes later than all that was sent.
  const bool goes_with_clock =
      config_.pace == Pace::kRealTime && config_.speed <= 1.0;
  return goes_with_clock && simulation_->now() <= bus_->now() ? Duration(0)
                                                              : kSaveLead;
}

void SimulatorProcess::Finish() {
  SaveState(Duration(0));
  saver_.Flush();
  for (const CameraFeed& camera : cameras_) {
    spdlog::info("{}: {} images sent, {} left out",
                 camera.image_channel(),
                 camera.num_sent(),
                 camera.num_missed());
  }
  ShowFault(bus_->now());
}

void SimulatorProcess::ShowFault(Time now) {
  std::string fault;
  const auto add = [&](const std::string& text) {
    if (text.empty()) return;
    fault += (fault.empty() ? "" : "; ") + text;
  };
  if (lost_time_ && now - *lost_time_ < kRecent) {
    add(
        fmt::format("lost {:.2f} s in all: this machine stood still, or is too "
                    "slow for time.speed",
                    Seconds(clock_->lost())));
  }
  // Faster, or stepped, simulated time is ahead by its nature.
  if (simulation_ && config_.pace == Pace::kRealTime && config_.speed <= 1.0 &&
      simulation_->now() - now > kAhead) {
    add(
        fmt::format("time stamps are {:.0f} s ahead of the clock, as {} was: "
                    "they go back only without that file",
                    Seconds(simulation_->now() - now),
                    config_.state_file));
  }
  if (is_unanswered_) {
    add(fmt::format("no MOTION_COMMAND answered {} of ENCODERS in {:g} s",
                    num_unanswered_,
                    config_.answer_timeout_s));
  }
  for (const CameraFeed& camera : cameras_) {
    for (const std::string& text : camera.Faults(now - kRecent)) add(text);
  }
  add(saver_.fault());  // A full disk is no reason to stop.
  bus_->SetFault(fault);
}

// ---- messages --------------------------------------------------------------

void SimulatorProcess::Publish(std::vector<SimulationEvent> events) {
  SortForSending(&events);
  for (const SimulationEvent& event : events) {
    std::visit([this](const auto& e) { Publish(e); }, event);
  }
}

void SimulatorProcess::Publish(const EncoderEvent& event) {
  bus_->Publish(kEncoders, ToMessage(event, encoders_seq_++));
}

void SimulatorProcess::Publish(const RangeEvent& event) {
  bus_->Publish(kRanges, ToMessage(event, *range_options_));
}

void SimulatorProcess::Publish(const BaseEvent& event) {
  bus_->Publish(kBase, ToMessage(event, base_seq_++));
}

void SimulatorProcess::Publish(const TruthEvent& event) {
  bus_->Publish(kTruth, ToMessage(event, truth_seq_++));
}

void SimulatorProcess::Publish(const CameraEvent& event) {
  cameras_[static_cast<std::size_t>(event.camera)].Expose(event);
}

void SimulatorProcess::PublishCameraInfo(Time simulated) {
  if (info_time_ && simulated - *info_time_ < kInfoPeriod) return;
  info_time_ = simulated;
  for (CameraFeed& camera : cameras_) camera.PublishInfo(simulated, info_seq_);
  ++info_seq_;
}

}  // namespace waymark
