#include "processes/simulator/simulator_process.h"
#include "processes/support/run_process.h"

int main(int argc, char** argv) {
  return waymark::RunProcess<waymark::SimulatorProcess>(argc, argv);
}
