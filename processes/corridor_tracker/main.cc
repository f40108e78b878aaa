#include "processes/corridor_tracker/corridor_tracker_process.h"
#include "processes/support/run_process.h"

int main(int argc, char** argv) {
  return waymark::RunProcess<waymark::CorridorTrackerProcess>(argc, argv);
}
