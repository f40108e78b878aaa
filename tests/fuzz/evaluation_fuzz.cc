// What waymark-log evaluate does with a log of hostile content: tables and
// JSON, without an exception.
#include "logs/evaluation/evaluation_text.h"
#include "logs/evaluation/log_evaluation.h"
#include "tests/fuzz/message_stream.h"

#include <nlohmann/json.hpp>

#include <array>

namespace waymark::fuzz {

void RunOne(Bytes data) {
  const std::string path = ScratchFolder() + "/evaluated.lcm";
  if (WriteStreamLog(data, path) == 0) return;
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
