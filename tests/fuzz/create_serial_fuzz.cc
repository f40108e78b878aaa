// Bytes from the serial port of a robot's base.
#include "drivers/wheels/create_session.h"
#include "tests/fuzz/fuzz_target.h"
#include "tests/support/create_emulator.h"

#include <algorithm>
#include <cstdlib>

namespace waymark::fuzz {
namespace {

// Each input byte is also a portion's length, so that the fuzzer chooses where
// reads end.
void Feed(Bytes data, CreateSession* session, Time* now) {
  std::size_t num_frames = 0;
  while (!data.empty()) {
    const auto portion = std::min<std::size_t>(data.size(), 1 + data[0] % 64);
    *now += Duration(10'000);
    session->Command(*now, 0.4, -1.0);
    const waymark::Bytes sent = session->Send(*now);
    if (sent.size() == 5 && sent[0] == 145) {
      for (const std::size_t i : {1u, 3u}) {
        const auto speed =
            static_cast<std::int16_t>(sent[i] << 8 | sent[i + 1]);
        Expect(std::abs(speed) <= kCreateMaxSpeed, "speeds are in range");
      }
    }
    session->Receive(*now, data.first(portion));
    if (const auto reading = session->TakeReading()) {
      ++num_frames;
      Expect(!reading->battery ||
                 (*reading->battery >= 0.0 && *reading->battery <= 1.0),
             "the charge is a share");
    }
    data = data.subspan(portion);
  }
  const CreateStreamParser& parser = session->parser();
  Expect(parser.num_frames() >= static_cast<std::int64_t>(num_frames),
         "a reading is a frame");
}

}  // namespace

void RunOne(Bytes data) {
  CreateSession session{CreateSessionOptions{}};
  Time now = TimeFromMicroseconds(1'000'000);
  session.Open(now);
  for (int i = 0; i < 3; ++i) {
    now += Duration(40'000);
    (void)session.Send(now);
  }
  Feed(data, &session, &now);
  // Whatever came, whole frames are understood again.
  CreateEmulator robot;
  robot.Receive(EncodeStart());
  robot.Receive(EncodeStream());
  const std::int64_t before = session.parser().num_frames();
  session.Receive(now, robot.Step(0.15));
  // One may be lost to what looked like the beginning of another.
  Expect(session.parser().num_frames() - before >= 9, "frames are found again");
  Expect(session.parser().num_skipped() <=
             static_cast<std::int64_t>(data.size()) + 40,
         "no byte is skipped twice");
}

std::vector<std::string> Seeds() {
  CreateEmulator robot;
  robot.Receive(EncodeStart());
  robot.Receive(EncodeMode(CreateMode::kSafe));
  robot.Receive(EncodeStream());
  robot.Receive(EncodeDriveDirect(200, 100));
  std::vector<std::string> seeds;
  for (int i = 0; i < 4; ++i) {
    robot.SetBumpers(i == 1, i == 2);
    robot.SetWheelDrop(i == 3);
    const auto bytes = robot.Step(0.015 * (1 + i));
    seeds.emplace_back(bytes.begin(), bytes.end());
  }
  seeds.emplace_back("bl-start\r\nSTR730\r\nbootloader id: #x47175347\r\n");
  seeds.emplace_back("\x13\xff\x07");
  return seeds;
}

}  // namespace waymark::fuzz
