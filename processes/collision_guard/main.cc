#include "processes/collision_guard/collision_guard_process.h"
#include "processes/support/run_process.h"

int main(int argc, char** argv) {
  return waymark::RunProcess<waymark::CollisionGuardProcess>(argc, argv);
}
