// A small process for tests of the runner and the buses: each ENCODERS becomes
// an ODOMETRY with the sum of all left ticks so far, in metres.
#pragma once

#include "processes/support/bus.h"
#include "processes/support/channels.h"

#include <waymark/encoders_t.hpp>
#include <waymark/odometry_parameters_t.hpp>
#include <waymark/pose_t.hpp>

#include <chrono>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <string_view>
#include <thread>

namespace waymark {

struct EchoConfig {
  double scale = 1.0;
  std::int64_t throw_at = -1;
  std::int64_t sleep_us = 0;
  bool finish_pose = true;

  void Describe(Describer& d) {
    d.Number("scale", &scale, {0.0, 10.0}, "Metres per tick");
    d.Integer("throw_at",
              &throw_at,
              -1,
              1000000,
              "Number of the message at which the handler throws; -1: none");
    d.Integer("sleep_us", &sleep_us, 0, 1000000, "How long a handler takes");
    d.Flag("finish_pose", &finish_pose, "Publish a POSE at the end");
  }
  void Check() const {
    if (scale == 3.0) throw std::invalid_argument("scale = 3: is taken");
  }
};

class EchoProcess {
 public:
  using Config = EchoConfig;
  static constexpr std::string_view kName = "echo";

  EchoProcess(const Config& config, Bus* bus) : config_(config), bus_(bus) {
    bus->Advertise<pose_t>(kOdometry);
    bus->Advertise<pose_t>(kPose);
    bus->Advertise<odometry_parameters_t>(kOdometryParameters, "online");
    bus->Subscribe<encoders_t>(
        kEncoders, Keep::All(100000), [this](const encoders_t& m, Time) {
          OnEncoders(m);
        });
    bus->Subscribe<odometry_parameters_t>(
        kOdometryParameters,
        Keep::All(),
        [this](const odometry_parameters_t& m, Time) {
          if (m.source == "nominal") ++num_nominal_;
        });
  }

  void Finish() {
    if (!config_.finish_pose) return;
    pose_t pose;
    pose.utime = odometry_.utime;
    pose.seq = 0;
    pose.reason = "sum " + std::to_string(odometry_.pose_W[0]) + " after " +
                  std::to_string(num_nominal_) + " nominal";
    bus_->Publish(kPose, pose);
  }

 private:
  void OnEncoders(const encoders_t& message) {
    if (message.seq == config_.throw_at) {
      throw std::runtime_error("handler threw as configured");
    }
    std::this_thread::sleep_for(std::chrono::microseconds(config_.sleep_us));
    odometry_.utime = message.utime;
    odometry_.is_known = 1;
    odometry_.pose_W[0] +=
        config_.scale * static_cast<double>(message.left_ticks);
    bus_->Publish(kOdometry, odometry_);
    ++odometry_.seq;
    odometry_parameters_t parameters;
    parameters.utime = message.utime;
    parameters.seq = message.seq;
    parameters.source = "online";
    parameters.k_right = odometry_.pose_W[0];
    bus_->Publish(kOdometryParameters, parameters);
  }

  Config config_;
  Bus* bus_;
  pose_t odometry_;
  std::int64_t num_nominal_ = 0;
};

}  // namespace waymark
