#include "processes/simulator/simulator_process.h"

#include "drivers/simulator/build_scene.h"
#include "drivers/simulator/mesh_outline.h"
#include "estimation/base/input_error.h"
#include "estimation/geometry/angle.h"
#include "processes/convert/motion_convert.h"
#include "processes/convert/world_file.h"
#include "processes/simulator/robot_state_file.h"
#include "processes/support/channels.h"

#include <waymark/base_status_t.hpp>
#include <waymark/camera_info_t.hpp>
#include <waymark/encoders_t.hpp>
#include <waymark/planar_lidar_t.hpp>
#include <waymark/truth_t.hpp>

#include <spdlog/fmt/fmt.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

namespace waymark {
namespace {

// Half the height of what a planar sensor sees, m: a beam has a width.
constexpr double kHalfPlane = 0.01;
constexpr std::string_view kSource = "simulator";
constexpr Duration kInfoPeriod = std::chrono::seconds(1);
constexpr Duration kSavePeriod = std::chrono::seconds(1);
// Simulated time that may pass before a saved state is on disk, where it goes
// faster than the clock: the fastest answers, and a slow disk.
constexpr Duration kSaveLead = std::chrono::seconds(60);
// What has happened is a fault for so long: in several STATUS.
constexpr Duration kRecent = std::chrono::seconds(5);
// Live, a reading is sent so long after its own time: more than a timer is
// early or late, so that each tick has just one.
constexpr Duration kTimerSlack = std::chrono::milliseconds(2);

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

}  // namespace

SimulatorProcess::SimulatorProcess(const Config& config, Bus* bus)
    : config_(config),
      bus_(bus),
      world_(LoadWorldFile(FindWorldFile(config.world))),
      scene_(BuildScene(world_, LooksFor(config))),
      area_(world_, scene_.mesh, config.robot.height),
      people_(world_, PeopleOptions{config.robot.radius}),
      range_options_(RangeOptions(config)),
      saver_(config.state_file, bus->is_offline()) {
  if (config.range_height > 0.0) {
    seen_.emplace(OutlineOfMesh(scene_.mesh,
                                {.low = config.range_height - kHalfPlane,
                                 .high = config.range_height + kHalfPlane}));
  }
  start_.X_WR = StartPose();
  CheckPlace(start_.X_WR, world_.source + ": start");
  if (!config_.state_file.empty()) LoadState();
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
  const double speed = config_.pace == Pace::kRealTime ? config_.speed : 1.0;
  bus->Every(DurationFromSeconds(1.0 / (config_.encoder_rate_hz * speed)),
             [this](Time now) {
               config_.pace == Pace::kRealTime ? OnTick(now) : OnStepTick(now);
               ShowFault(now);
             });
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

void SimulatorProcess::CheckPlace(const Pose2& X_WR,
                                  const std::string& source) const {
  const double radius = config_.robot.radius;
  const std::string robot =
      fmt::format("{}: a robot of radius {:g} m at x {:.3f}, y {:.3f}",
                  source,
                  radius,
                  X_WR.x,
                  X_WR.y);
  if (const auto nearest = area_.map().Nearest(X_WR.position(), radius)) {
    throw InputError(
        fmt::format("{} would touch something at x {:.3f}, y {:.3f}",
                    robot,
                    nearest->p_W.x(),
                    nearest->p_W.y()));
  }
  if (area_.Clearance(X_WR.position()) < 0.0) {
    throw InputError(robot +
                     " would be outside of all rooms, or inside something");
  }
}

void SimulatorProcess::LoadState() {
  const auto saved = LoadRobotState(config_.state_file);
  if (!saved) return;
  saved_time_ = saved->time;
  if (saved->world != world_.source) return;
  CheckPlace(saved->snapshot.X_WR, config_.state_file + ": pose");
  start_ = saved->snapshot;
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
  Camera camera;
  camera.rig = std::make_unique<CameraRig>(
      config, renderer_.get(), static_cast<std::uint64_t>(config_.seed));
  bus_->Advertise<image_t>(camera.rig->image_channel());
  bus_->Advertise<camera_info_t>(camera.rig->info_channel());
  cameras_.push_back(std::move(camera));
}

Simulation SimulatorProcess::MakeSimulation(Time start) const {
  SimulationOptions options;
  options.robot = config_.robot;
  options.encoder_rate_hz = config_.encoder_rate_hz;
  options.truth_rate_hz = config_.encoder_rate_hz;
  options.status_rate_hz = config_.status_rate_hz;
  options.ranges = range_options_;
  for (const Camera& camera : cameras_) {
    options.cameras.push_back(camera.rig->timing());
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

Time SimulatorProcess::StartTime(Time now) const {
  const bool is_live = config_.pace == Pace::kRealTime && !bus_->is_offline();
  const Time start = is_live ? now - kTimerSlack : now;
  if (!saved_time_ || *saved_time_ < start) return start;
  spdlog::info("goes on {:.1f} s ahead of the clock, where it was",
               Seconds(*saved_time_ - now));
  return *saved_time_ + Duration(1);
}

void SimulatorProcess::OnTick(Time now) {
  if (!simulation_) {
    const Time start = StartTime(now);
    simulation_.emplace(MakeSimulation(start));
    clock_.emplace(
        config_.speed, now, bus_->is_offline() ? start : start + kTimerSlack);
  }
  const Duration lost = clock_->lost();
  const Time simulated = clock_->At(now);
  if (clock_->lost() > lost) lost_time_ = now;
  AdvanceTo(simulated);
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
  PublishImages(simulated);
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
  for (const Camera& camera : cameras_) {
    spdlog::info("{}: {} images sent, {} left out",
                 camera.rig->image_channel(),
                 camera.num_sent,
                 camera.num_missed);
  }
  ShowFault(bus_->now());
}

void SimulatorProcess::ShowFault(Time now) {
  std::string fault;
  const auto add = [&](const std::string& text) {
    if (text.empty()) return;
    fault += (fault.empty() ? "" : "; ") + text;
  };
  const auto is_recent = [&](const std::optional<Time>& time) {
    return time && now - *time < kRecent;
  };
  if (is_recent(lost_time_)) {
    add(
        fmt::format("lost {:.2f} s in all: this machine stood still, or is too "
                    "slow for time.speed",
                    Seconds(clock_->lost())));
  }
  if (is_unanswered_) {
    add(fmt::format("no MOTION_COMMAND answered {} of ENCODERS in {:g} s",
                    num_unanswered_,
                    config_.answer_timeout_s));
  }
  for (const Camera& camera : cameras_) {
    if (is_recent(camera.missed_time)) {
      add(
          fmt::format("{}: {} images not drawn: this machine is too slow for "
                      "their rate",
                      camera.rig->image_channel(),
                      camera.num_missed));
    }
    add(camera.fault);
  }
  add(saver_.fault());  // A full disk is no reason to stop.
  bus_->SetFault(fault);
}

// ---- messages --------------------------------------------------------------

void SimulatorProcess::Publish(const std::vector<SimulationEvent>& events) {
  // ENCODERS of one time come last: who answers them has seen the rest.
  for (std::size_t begin = 0; begin < events.size();) {
    std::size_t end = begin;
    while (end < events.size() &&
           TimeOf(events[end]) == TimeOf(events[begin])) {
      ++end;
    }
    for (const bool encoders : {false, true}) {
      for (std::size_t i = begin; i < end; ++i) {
        std::visit(
            [&](const auto& event) {
              constexpr bool kIsEncoders =
                  std::is_same_v<std::decay_t<decltype(event)>, EncoderEvent>;
              if constexpr (std::is_same_v<std::decay_t<decltype(event)>,
                                           CameraEvent>) {
                if (!encoders) Expose(event);
              } else if (kIsEncoders == encoders) {
                Publish(event);
              }
            },
            events[i]);
      }
    }
    begin = end;
  }
}

void SimulatorProcess::Publish(const EncoderEvent& event) {
  encoders_t message{};
  message.utime = Microseconds(event.time);
  message.seq = static_cast<std::int32_t>(encoders_seq_++);
  message.left_ticks = event.left_ticks;
  message.right_ticks = event.right_ticks;
  bus_->Publish(kEncoders, message);
}

void SimulatorProcess::Publish(const RangeEvent& event) {
  planar_lidar_t message{};
  message.utime = Microseconds(event.time);
  message.nranges = static_cast<std::int32_t>(event.ranges.size());
  message.ranges = event.ranges;
  message.rad0 = static_cast<float>(range_options_->first_bearing);
  message.radstep = static_cast<float>(range_options_->bearing_step);
  bus_->Publish(kRanges, message);
}

void SimulatorProcess::Publish(const BaseEvent& event) {
  base_status_t message{};
  message.utime = Microseconds(event.time);
  message.seq = static_cast<std::int32_t>(base_seq_++);
  message.is_bumper_left = event.is_left_bumper_pressed;
  message.is_bumper_right = event.is_right_bumper_pressed;
  message.is_command_current = event.is_command_current;
  message.num_contacts = static_cast<std::int32_t>(event.num_touches);
  message.num_timeouts = static_cast<std::int32_t>(event.num_timeouts);
  bus_->Publish(kBase, message);
}

void SimulatorProcess::Publish(const TruthEvent& event) {
  truth_t message{};
  message.utime = Microseconds(event.time);
  message.seq = static_cast<std::int32_t>(truth_seq_++);
  message.source = kSource;
  message.has_heading = 1;
  message.x = event.X_WR.x;
  message.y = event.X_WR.y;
  message.heading = event.X_WR.heading;
  bus_->Publish(kTruth, message);
}

// ---- images ----------------------------------------------------------------

void SimulatorProcess::Expose(const CameraEvent& event) {
  Camera& camera = cameras_[static_cast<std::size_t>(event.camera)];
  // Live, an image is drawn in a thread of its own while wheels and sonar go
  // on; otherwise when it arrives, and whatever that takes.
  const bool is_live = config_.pace == Pace::kRealTime && !bus_->is_offline();
  if (is_live && !camera.pending.empty() &&
      camera.pending.back().shot.wait_for(std::chrono::seconds(0)) !=
          std::future_status::ready) {
    ++camera.num_missed;
    camera.missed_time = bus_->now();
    return;
  }
  camera.pending.push_back(
      {event.frame.arrival,
       std::async(
           is_live ? std::launch::async : std::launch::deferred,
           [rig = camera.rig.get(), event] { return rig->Expose(event); })});
}

void SimulatorProcess::PublishImages(Time simulated) {
  for (Camera& camera : cameras_) {
    while (!camera.pending.empty()) {
      Pending& next = camera.pending.front();
      if (next.arrival > simulated || next.shot.wait_for(std::chrono::seconds(
                                          0)) == std::future_status::timeout) {
        break;
      }
      const CameraRig::Shot shot = next.shot.get();
      camera.pending.pop_front();
      camera.fault = shot.reason;
      if (!shot.image) continue;
      ++camera.num_sent;
      bus_->Publish(camera.rig->image_channel(), *shot.image);
    }
  }
}

void SimulatorProcess::PublishCameraInfo(Time simulated) {
  if (info_time_ && simulated - *info_time_ < kInfoPeriod) return;
  info_time_ = simulated;
  for (const Camera& camera : cameras_) {
    bus_->Publish(camera.rig->info_channel(),
                  camera.rig->Info(simulated, info_seq_));
  }
  ++info_seq_;
}

}  // namespace waymark
