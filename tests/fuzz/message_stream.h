// Hostile input as a process or an evaluation gets it: messages of the right
// types on the right channels, with any content.
//
// Each message in a stream: one byte that chooses the channel, two with the
// length (big endian), and the message without its fingerprint. The last one
// may be cut short. At most 300 are read.
#pragma once

#include "processes/support/local_bus.h"
#include "tests/fuzz/fuzz_target.h"

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace waymark::fuzz {

struct StreamMessage {
  std::string_view channel;
  std::vector<std::uint8_t> data;  // Fingerprint first.
};

// Publishes the messages in a stream, one per millisecond, but for those that
// would pass for what the process under test publishes.
void PublishStream(Bytes data,
                   const std::function<bool(const StreamMessage&)>& is_output,
                   LocalBus* world);

// Writes the messages in a stream, one per millisecond, into a log that
// replaces what is at `path`. Returns how many they are.
std::int64_t WriteStreamLog(Bytes data, const std::string& path);

// A short drive: parameters, start, ticks, fixes, reference, estimates.
std::vector<std::string> StreamSeeds();

// A task that is driven, with ranges, a bump, a stop and letting go.
std::string MotionStreamSeed();

}  // namespace waymark::fuzz
