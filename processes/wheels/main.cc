#include "processes/support/run_process.h"
#include "processes/wheels/wheels_process.h"

int main(int argc, char** argv) {
  return waymark::RunProcess<waymark::WheelsProcess>(argc, argv);
}
