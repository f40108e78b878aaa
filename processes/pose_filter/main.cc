#include "processes/pose_filter/pose_filter_process.h"
#include "processes/support/run_process.h"

int main(int argc, char** argv) {
  return waymark::RunProcess<waymark::PoseFilterProcess>(argc, argv);
}
