#include "processes/support/run_process.h"
#include "processes/tour_driver/tour_driver_process.h"

int main(int argc, char** argv) {
  return waymark::RunProcess<waymark::TourDriverProcess>(argc, argv);
}
