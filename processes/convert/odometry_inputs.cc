#include "processes/convert/odometry_inputs.h"

#include "processes/convert/corridor_convert.h"
#include "processes/convert/odometry_convert.h"
#include "processes/support/channels.h"

#include <optional>
#include <string>
#include <string_view>
#include <utility>

namespace waymark {
namespace {

struct CountedReading {
  EncoderReading reading;
  int counter_bits = 0;
};

std::optional<CountedReading> CountedReadingFromMessage(
    const encoders_t& message, std::string* reason) {
  const auto reading = EncoderReadingFromMessage(message, reason);
  if (!reading) return std::nullopt;
  return CountedReading{*reading, message.counter_bits};
}

template <typename Message, typename Value>
void SubscribeValues(Bus* bus,
                     std::string_view channel,
                     std::optional<Value> (*from_message)(const Message&,
                                                          std::string*),
                     std::function<void(const Value&)> handle) {
  if (!handle) return;
  bus->Subscribe<Message>(
      channel,
      Keep::All(),
      [bus, channel, from_message, handle = std::move(handle)](const Message& m,
                                                               Time) {
        std::string reason;
        if (const std::optional<Value> value = from_message(m, &reason)) {
          handle(*value);
        } else {
          bus->ReportBad(channel, Bad::kContent, reason);
        }
      });
}

template <typename Message>
void SubscribeFixes(
    Bus* bus,
    std::string_view channel,
    std::optional<AbsoluteFix> (*from_message)(const Message&, std::string*),
    const std::function<void(const AbsoluteFix&, std::string_view)>& handle) {
  if (!handle) return;
  SubscribeValues<Message, AbsoluteFix>(
      bus, channel, from_message, [channel, handle](const AbsoluteFix& fix) {
        // An answer 'none' is no measurement.
        if (fix.has_any()) handle(fix, channel);
      });
}

}  // namespace

void SubscribeOdometryInputs(Bus* bus, const OdometryInputs& inputs) {
  std::function<void(const CountedReading&)> on_counted;
  if (inputs.on_reading) {
    on_counted = [on_reading = inputs.on_reading](const CountedReading& c) {
      on_reading(c.reading, c.counter_bits);
    };
  }
  std::function<void(const OdometryParameters&)> on_any_parameters;
  if (inputs.on_parameters) {
    on_any_parameters =
        [on_parameters = inputs.on_parameters](const OdometryParameters& p) {
          if (p.is_known) on_parameters(p);
        };
  }
  SubscribeValues(
      bus, kEncoders, CountedReadingFromMessage, std::move(on_counted));
  SubscribeFixes(bus, kPositionFix, AbsoluteFixFromMessage, inputs.on_fix);
  SubscribeFixes(bus, kCorridorPose, CorridorFixFromMessage, inputs.on_fix);
  SubscribeValues(
      bus, kRelativeMotion, RelativeMotionFromMessage, inputs.on_motion);
  SubscribeValues(
      bus, kInitialPose, InitialPoseFromMessage, inputs.on_initial_pose);
  SubscribeValues(bus,
                  kOdometryParameters,
                  OdometryParametersFromMessage,
                  std::move(on_any_parameters));
}

}  // namespace waymark
