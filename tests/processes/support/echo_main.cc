// The echo process as an executable, for tests of the runner.
#include "processes/support/run_process.h"
#include "tests/processes/support/echo_process.h"

int main(int argc, char** argv) {
  return waymark::RunProcess<waymark::EchoProcess>(argc, argv);
}
