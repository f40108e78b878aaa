#include "processes/batch_refiner/batch_refiner_process.h"
#include "processes/support/run_process.h"

int main(int argc, char** argv) {
  return waymark::RunProcess<waymark::BatchRefinerProcess>(argc, argv);
}
