// make_samples FOLDER: writes the logs of logs/samples again.
#include "tests/support/log_samples.h"

#include <cstdio>
#include <exception>

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: make_samples FOLDER\n");
    return 2;
  }
  try {
    for (const std::string& name : waymark::SampleNames()) {
      const std::string path = std::string(argv[1]) + "/" + name;
      waymark::WriteSample(name, path, waymark::IfExists::kReplace);
      std::printf("%s\n", path.c_str());
    }
  } catch (const waymark::InputError& error) {
    std::fprintf(stderr, "make_samples: %s\n", error.what());
    return 2;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "make_samples: %s\n", error.what());
    return 1;
  }
  return 0;
}
