// The results of a sweep, run by run, on disk.
#pragma once

#include "processes/tools/experiment/experiment.h"

#include <cstdint>
#include <map>
#include <string>

namespace waymark {

// One JSON object a line: first what was run, then one line per seed. A line
// is on disk as soon as its run has ended, and a sweep that was killed, also
// while it wrote, goes on from the file.
class ResultsFile {
 public:
  // Opens or starts `path`. Throws InputError where it cannot be used, or holds
  // results of another experiment or configuration.
  ResultsFile(const std::string& path,
              const std::string& experiment,
              const std::string& configuration);
  ~ResultsFile();
  ResultsFile(const ResultsFile&) = delete;
  ResultsFile& operator=(const ResultsFile&) = delete;

  [[nodiscard]] const std::map<std::uint64_t, RunResult>& results() const {
    return results_;
  }
  void Add(const RunResult& result);
  // Puts the lines in the order of seeds: the same runs, the same bytes.
  void Sort() const;

 private:
  void Read(const std::string& text);

  std::string path_;
  std::string header_;
  std::map<std::uint64_t, RunResult> results_;
  int fd_ = -1;
};

// One line without its end; back again, every number bit for bit. The latter
// throws InputError where the text is none.
[[nodiscard]] std::string LineOfResult(const RunResult& result);
[[nodiscard]] RunResult ResultOfLine(const std::string& line);

}  // namespace waymark
