// Generated decoders of all message types, behind DecodeMessage. The first
// byte chooses the type; its fingerprint is put in front, so that the fuzzer
// need not guess it.
#include "processes/support/decode.h"
#include "tests/fuzz/fuzz_target.h"

#include <waymark_all_types.hpp>

#include <algorithm>
#include <array>
#include <iterator>
#include <optional>

namespace waymark::fuzz {
namespace {

template <typename M>
std::vector<std::uint8_t> Encode(const M& message) {
  std::vector<std::uint8_t> data(
      static_cast<std::size_t>(message.getEncodedSize()));
  const int size =
      message.encode(data.data(), 0, static_cast<int>(data.size()));
  Expect(size >= 0, "what was decoded can be encoded");
  data.resize(static_cast<std::size_t>(size));
  return data;
}

template <typename M>
void Decode(Bytes body) {
  const auto data =
      WithFingerprint(static_cast<std::uint64_t>(M::getHash()), body);
  const std::optional<M> message = DecodeMessage<M>(data);
  (void)DecodeMessage<M>(body);  // Fingerprint not given: nearly always wrong.
  if (!message) return;
  (void)SequenceOf(*message);
  (void)SenderOf(*message);
  // A text with a zero byte inside is cut there, so the first copy may be
  // shorter; the second must be the first again.
  const auto once = Encode(*message);
  Expect(once.size() <= data.size(), "no longer than it came");
  const std::optional<M> again = DecodeMessage<M>(once);
  Expect(again.has_value(), "what was encoded decodes");
  Expect(Encode(*again) == once, "round trip");
}

#define DECODE(package, type) Decode<::package::type>,
constexpr std::array kDecoders{WAYMARK_FOR_EACH_MESSAGE_TYPE(DECODE)};
#undef DECODE

// Index of a type among them, for the seeds.
#define NAME(package, type) std::string_view(#package "." #type),
constexpr std::string_view kNames[] = {WAYMARK_FOR_EACH_MESSAGE_TYPE(NAME)};
#undef NAME

template <typename M>
std::string Seed(std::string_view name, const M& message) {
  const auto index = std::find(std::begin(kNames), std::end(kNames), name) -
                     std::begin(kNames);
  const auto data = Encode(message);
  return std::string(1, static_cast<char>(index)) +
         std::string(data.begin() + 8, data.end());
}

waymark::image_t Image() {
  waymark::image_t image;
  image.width = 2;
  image.height = 1;
  image.size = 2;
  image.data = {7, 8};
  image.nmetadata = 1;
  image.metadata.resize(1);
  image.metadata[0].key = "seq";
  image.metadata[0].n = 8;
  image.metadata[0].value.assign(8, 1);
  return image;
}

waymark::status_t Status() {
  waymark::status_t status;
  status.process = "pose_filter";
  status.num_channels = 2;
  status.channels.resize(2);
  status.channels[0].channel = "ENCODERS";
  return status;
}

bot_procman::orders2_t Orders() {
  bot_procman::orders2_t orders;
  orders.host = "robot";
  orders.ncmds = 1;
  orders.cmds.resize(1);
  orders.cmds[0].cmd.exec_str = "pose_filter --config a.yaml";
  orders.cmds[0].cmd.num_options = 1;
  orders.cmds[0].cmd.option_names = {"a"};
  orders.cmds[0].cmd.option_values = {"b"};
  return orders;
}

procman_lcm::output_t Output() {
  procman_lcm::output_t output;
  output.num_commands = 2;
  output.command_ids = {"a", "b"};
  output.text = {"hello", ""};
  return output;
}

}  // namespace

void RunOne(Bytes data) {
  if (data.empty()) return;
  kDecoders[data[0] % kDecoders.size()](data.subspan(1));
}

std::vector<std::string> Seeds() {
  std::vector<std::string> seeds = {
      Seed("waymark.image_t", Image()),
      Seed("waymark.status_t", Status()),
      Seed("bot_procman.orders2_t", Orders()),
      Seed("procman_lcm.output_t", Output()),
  };
  // Empty arrays and texts, which every type takes.
#define EMPTY(package, type) \
  seeds.push_back(Seed(#package "." #type, ::package::type()));
  WAYMARK_FOR_EACH_MESSAGE_TYPE(EMPTY)
#undef EMPTY
  return seeds;
}

}  // namespace waymark::fuzz
