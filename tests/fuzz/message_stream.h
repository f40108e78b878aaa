// Hostile input as a process or an evaluation gets it: messages of the right
// types on the right channels, with any content.
#pragma once

#include "tests/fuzz/fuzz_target.h"

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace waymark::fuzz {

struct StreamMessage {
  std::string_view channel;
  std::vector<std::uint8_t> data;  // Fingerprint first.
};

// Each message in `data`: one byte that chooses the channel, two with the
// length (big endian), and the message without its fingerprint. The last one
// may be cut short. At most 300.
std::vector<StreamMessage> ReadStream(Bytes data);

// A short drive: parameters, start, ticks, fixes, reference, estimates.
std::vector<std::string> StreamSeeds();

}  // namespace waymark::fuzz
