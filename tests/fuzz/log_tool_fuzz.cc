// What waymark-log info, check and repair do with any file.
#include "logs/log_tool/log_check.h"
#include "logs/log_tool/log_copy.h"
#include "logs/log_tool/log_summary.h"
#include "logs/log_tool/type_table.h"
#include "processes/support/log_file.h"
#include "tests/fuzz/message_stream.h"

#include <fstream>
#include <iterator>

namespace waymark::fuzz {
namespace {

void RunFile(const std::string& path) {
  static TypeTable types("");
  TakesOrRefuses([&] {
    const LogSummary summary = SummariseLog(path, &types);
    (void)DamageText(path, summary.report, 5);
    const LogCheck check = CheckLog(path, &types);
    Expect(check.report.num_events == summary.report.num_events,
           "both read the same events");
    LogCopyOptions options;
    options.if_exists = IfExists::kReplace;
    const std::string repaired = ScratchFolder() + "/repaired.lcm";
    const LogCopyReport copy = CopyLog(path, repaired, options);
    Expect(copy.num_events == check.report.num_events, "all events are kept");
    if (copy.num_events == 0) return;
    LogReader reader(repaired);
    while (reader.Next()) {
    }
    Expect(reader.report().is_sound(), "a repaired log is sound");
    Expect(reader.report().num_events == copy.num_events, "and complete");
  });
}

}  // namespace

// The first byte chooses: a file as it is, or a sound log of hostile messages.
void RunOne(Bytes data) {
  if (data.empty()) return;
  if (data[0] % 2 == 0) return RunFile(WriteScratch("a.lcm", data.subspan(1)));
  const std::string path = ScratchFolder() + "/b.lcm";
  if (WriteStreamLog(data.subspan(1), path) > 0) RunFile(path);
}

std::vector<std::string> Seeds() {
  std::vector<std::string> seeds;
  for (const std::string& stream : StreamSeeds()) {
    seeds.push_back("\x01" + stream);
    const std::string path = ScratchFolder() + "/seed.lcm";
    WriteStreamLog(AsBytes(stream), path);
    std::ifstream file(path, std::ios::binary);
    seeds.push_back(std::string(1, '\0') +
                    std::string(std::istreambuf_iterator<char>(file), {}));
  }
  return seeds;
}

}  // namespace waymark::fuzz
