// Entry points of libFuzzer. WAYMARK_WRITE_SEEDS=<folder> writes the seeds
// there and ends.
#include "tests/fuzz/fuzz_target.h"

#include <cstdlib>
#include <fstream>

extern "C" int LLVMFuzzerInitialize(int* /*argc*/, char*** /*argv*/) {
  const char* folder = std::getenv("WAYMARK_WRITE_SEEDS");
  if (folder == nullptr) return 0;
  int number = 0;
  for (const std::string& seed : waymark::fuzz::Seeds()) {
    std::ofstream file(
        std::string(folder) + "/seed_" + std::to_string(number++),
        std::ios::binary);
    file << seed;
    waymark::fuzz::Expect(file.good(), "write a seed");
  }
  std::exit(0);
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data,
                                      std::size_t size) {
  waymark::fuzz::RunOne({data, size});
  return 0;
}
