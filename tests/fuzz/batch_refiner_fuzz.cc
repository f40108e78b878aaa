// batch_refiner on hostile messages: no exception, and what it publishes can be
// used. The first byte chooses the configuration.
#include "processes/batch_refiner/batch_refiner_process.h"
#include "processes/support/channels.h"
#include "processes/support/local_bus.h"
#include "tests/fuzz/message_stream.h"

#include <waymark/odometry_parameters_t.hpp>

#include <spdlog/spdlog.h>

#include <cmath>

namespace waymark::fuzz {
namespace {

// Few iterations: what the solver is given matters here, not how well it ends.
BatchRefinerConfig ConfigOf(std::uint8_t choice) {
  BatchRefinerConfig config;
  config.window.window_s = 10.0;
  config.window.max_readings = 40;
  config.window.max_measurements = 10;
  config.period_s = 5.0;
  config.solver.options.max_iterations = 3;
  config.solver.options.max_rounds = 2;
  config.solver.options.min_observability = 1e-3;
  if ((choice & 1) != 0) config.nominal = {1e-4, 1e-4, 0.3};
  config.solver.calibrate_position = (choice & 2) != 0;
  config.solver.calibrate_yaw = (choice & 4) != 0;
  config.solver.calibrate_time_offset = (choice & 8) != 0;
  if ((choice & 16) != 0) {
    config.solver.options.odometry_loss = BatchLoss::kHuber;
  }
  return config;
}

bool IsAnswer(const StreamMessage& message) {
  if (message.channel != kOdometryParameters) return false;
  const auto parameters = DecodeMessage<odometry_parameters_t>(message.data);
  return parameters && parameters->source == "batch";
}

void CheckAnswer(const odometry_parameters_t& answer) {
  Expect(answer.is_known != 0 || !answer.reason.empty(), "known, or why not");
  for (const double value :
       {answer.k_right, answer.k_left, answer.wheel_base}) {
    Expect(std::isfinite(value), "finite parameters");
    Expect(answer.is_known == 0 || value > 0.0, "positive parameters");
  }
  for (const double value : answer.covariance) {
    Expect(std::isfinite(value), "finite covariance");
  }
  for (const int i : {0, 4, 8}) {
    Expect(answer.covariance[i] >= 0.0, "variance not negative");
  }
  for (const double value : answer.observability) {
    Expect(value >= 0.0 && value <= 1.0, "observability in [0, 1]");
  }
}

}  // namespace

void RunOne(Bytes data) {
  if (data.empty()) return;
  spdlog::set_level(spdlog::level::off);  // It warns of every bad message.
  LocalBus world;
  BatchRefinerProcess process(ConfigOf(data[0]),
                              world.AddProcess("batch_refiner"));
  PublishStream(data.subspan(1), IsAnswer, &world);
  world.Run();
  process.Finish();
  world.Run();
  for (const RawMessage& raw : world.recording()) {
    if (raw.channel != kOdometryParameters) continue;
    const auto message = DecodeMessage<odometry_parameters_t>(raw.data);
    if (message && message->source == "batch") CheckAnswer(*message);
  }
}

std::vector<std::string> Seeds() {
  const std::vector<std::string> streams = StreamSeeds();
  return {std::string(1, '\0') + streams.front(),
          "\x0f" + streams.back(),
          "\x11" + streams.back()};
}

}  // namespace waymark::fuzz
