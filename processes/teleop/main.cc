#include "processes/support/run_process.h"
#include "processes/teleop/teleop_process.h"

int main(int argc, char** argv) {
  return waymark::RunProcess<waymark::TeleopProcess>(argc, argv);
}
