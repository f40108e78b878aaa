#include "processes/path_follower/path_follower_process.h"
#include "processes/support/run_process.h"

int main(int argc, char** argv) {
  return waymark::RunProcess<waymark::PathFollowerProcess>(argc, argv);
}
