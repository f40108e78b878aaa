#include "processes/support/run_process.h"
#include "processes/video/video_process.h"

int main(int argc, char** argv) {
  return waymark::RunProcess<waymark::VideoProcess>(argc, argv);
}
