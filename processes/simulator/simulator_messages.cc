#include "processes/simulator/simulator_messages.h"

#include "estimation/base/time.h"

#include <algorithm>
#include <string_view>
#include <tuple>
#include <variant>

namespace waymark {
namespace {

constexpr std::string_view kSource = "simulator";

}  // namespace

encoders_t ToMessage(const EncoderEvent& event, std::int64_t seq) {
  encoders_t message{};
  message.utime = Microseconds(event.time);
  message.seq = static_cast<std::int32_t>(seq);
  message.left_ticks = event.left_ticks;
  message.right_ticks = event.right_ticks;
  return message;
}

planar_lidar_t ToMessage(const RangeEvent& event,
                         const RangeSensorOptions& options) {
  planar_lidar_t message{};
  message.utime = Microseconds(event.time);
  message.nranges = static_cast<std::int32_t>(event.ranges.size());
  message.ranges = event.ranges;
  message.rad0 = static_cast<float>(options.first_bearing);
  message.radstep = static_cast<float>(options.bearing_step);
  return message;
}

base_status_t ToMessage(const BaseEvent& event, std::int64_t seq) {
  base_status_t message{};
  message.utime = Microseconds(event.time);
  message.seq = static_cast<std::int32_t>(seq);
  message.is_bumper_left = event.is_left_bumper_pressed;
  message.is_bumper_right = event.is_right_bumper_pressed;
  message.is_command_current = event.is_command_current;
  message.num_contacts = static_cast<std::int32_t>(event.num_touches);
  message.num_timeouts = static_cast<std::int32_t>(event.num_timeouts);
  return message;
}

truth_t ToMessage(const TruthEvent& event, std::int64_t seq) {
  truth_t message{};
  message.utime = Microseconds(event.time);
  message.seq = static_cast<std::int32_t>(seq);
  message.source = kSource;
  message.has_heading = 1;
  message.x = event.X_WR.x;
  message.y = event.X_WR.y;
  message.heading = event.X_WR.heading;
  return message;
}

void SortForSending(std::vector<SimulationEvent>* events) {
  const auto place = [](const SimulationEvent& event) {
    return std::tuple(TimeOf(event),
                      std::holds_alternative<EncoderEvent>(event));
  };
  std::stable_sort(events->begin(),
                   events->end(),
                   [&](const SimulationEvent& a, const SimulationEvent& b) {
                     return place(a) < place(b);
                   });
}

}  // namespace waymark
