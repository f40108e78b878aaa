// What waymark-log evaluate does with a log of hostile content: tables and
// JSON, without an exception.
#include "logs/evaluation/evaluation_text.h"
#include "logs/evaluation/log_evaluation.h"
#include "processes/support/log_file.h"
#include "tests/fuzz/message_stream.h"

#include <nlohmann/json.hpp>

#include <array>

namespace waymark::fuzz {

void RunOne(Bytes data) {
  const std::string path = ScratchFolder() + "/evaluated.lcm";
  LogWriter writer(path, IfExists::kReplace);
  std::int64_t utime = 1'000'000'000;
  for (const StreamMessage& message : ReadStream(data)) {
    writer.Write(TimeFromMicroseconds(utime), message.channel, message.data);
    utime += 1000;
  }
  writer.Close();
  if (writer.num_events() == 0) return;
  TakesOrRefuses([&] {
    const std::array<std::string, 1> paths = {path};
    const LogEvaluation evaluation =
        EvaluateRecording(ReadRecording(paths), EvaluationOptions());
    (void)TableOf(evaluation);
    // With a source or process that is no UTF-8, too.
    (void)JsonOf(evaluation)
        .dump(2, ' ', false, nlohmann::json::error_handler_t::replace);
  });
}

std::vector<std::string> Seeds() {
  return StreamSeeds();
}

}  // namespace waymark::fuzz
