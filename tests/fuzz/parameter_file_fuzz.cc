// File of learned wheel parameters: refused in one line, or usable and the
// same again when saved and loaded.
#include "processes/pose_filter/parameter_file.h"
#include "tests/fuzz/fuzz_target.h"

#include <cmath>

namespace waymark::fuzz {
namespace {

bool IsSame(const OdometryParameters& a, const OdometryParameters& b) {
  return a.time == b.time && a.parameters.k_right == b.parameters.k_right &&
         a.parameters.k_left == b.parameters.k_left &&
         a.parameters.wheel_base == b.parameters.wheel_base &&
         a.covariance == b.covariance;
}

}  // namespace

void RunOne(Bytes data) {
  const MemoryFile file(data);
  std::optional<OdometryParameters> loaded;
  const bool taken =
      TakesOrRefuses([&] { loaded = LoadParameterFile(file.path()); });
  if (!taken) return;
  Expect(loaded.has_value(), "the file is there");
  Expect(loaded->parameters.k_right > 0 && loaded->parameters.k_left > 0 &&
             loaded->parameters.wheel_base > 0,
         "positive");
  Expect(loaded->covariance.allFinite(), "finite");
  const std::string copy = ScratchFolder() + "/parameters.yaml";
  SaveParameterFile(copy, *loaded);
  const auto again = LoadParameterFile(copy);
  Expect(again.has_value() && IsSame(*loaded, *again), "loads back");
}

std::vector<std::string> Seeds() {
  const std::string values =
      "utime: 1000000000\nk_right: 1e-4\nk_left: 1.1e-4\nwheel_base: 0.3\n";
  return {values +
              "covariance: [1e-12, 0, 0, 0, 1e-12, 0, 0, 0, 1e-6]\n"
              "num_measurements: 50\n",
          values + "covariance: [0, 0, 0, 0, 0, 0, 0, 0, 0]\n",
          values};
}

}  // namespace waymark::fuzz
