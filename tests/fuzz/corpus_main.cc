// Runs a fuzz target over its seeds, fixed mutations of them, and the files in
// the folders given (inputs that once failed). Prints the number of runs.
//
//   <target>_corpus [FOLDER...]
#include "tests/fuzz/fuzz_target.h"

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

namespace waymark::fuzz {
namespace {

// Per seed and kind of mutation: keeps each target's test below a second.
constexpr std::size_t kMaxPlaces = 100;

class Runner {
 public:
  void Run(const std::string& input) {
    RunOne(AsBytes(input));
    ++num_runs_;
  }

  // The seed, cut at and changed in evenly spread places: bits flipped, and
  // the numbers that break length fields.
  void RunMutations(const std::string& seed) {
    Run(seed);
    const std::size_t step = std::max<std::size_t>(1, seed.size() / kMaxPlaces);
    for (std::size_t at = 0; at < seed.size(); at += step) {
      Run(seed.substr(0, at));
      for (const char flip : {'\x01', '\x40', '\x80'}) {
        std::string changed = seed;
        changed[at] = static_cast<char>(changed[at] ^ flip);
        Run(changed);
      }
      for (const std::string& number : {std::string("\xff\xff\xff\xff", 4),
                                        std::string("\x7f\xff\xff\xff", 4),
                                        std::string("\x80\0\0\0", 4),
                                        std::string("\0\0\0\0", 4)}) {
        std::string changed = seed;
        changed.replace(at, 4, number);
        Run(changed);
      }
    }
  }

  [[nodiscard]] long num_runs() const { return num_runs_; }

 private:
  long num_runs_ = 0;
};

}  // namespace
}  // namespace waymark::fuzz

int main(int argc, char** argv) {
  waymark::fuzz::Runner runner;
  runner.Run("");
  for (const std::string& seed : waymark::fuzz::Seeds()) {
    runner.RunMutations(seed);
  }
  for (int i = 1; i < argc; ++i) {
    std::vector<std::string> paths;
    std::error_code missing;  // Most targets never failed: no folder.
    for (const auto& entry :
         std::filesystem::directory_iterator(argv[i], missing)) {
      paths.push_back(entry.path());
    }
    std::sort(paths.begin(), paths.end());
    for (const std::string& path : paths) {
      std::ifstream file(path, std::ios::binary);
      runner.Run({std::istreambuf_iterator<char>(file), {}});
    }
  }
  std::printf("%ld inputs\n", runner.num_runs());
  return 0;
}
