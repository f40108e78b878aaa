#include "processes/tools/wait/wait_tool.h"

int main(int argc, char** argv) {
  return waymark::RunWaitTool(argc, argv);
}
