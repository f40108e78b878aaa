#include "processes/tools/task/task_tool.h"

int main(int argc, char** argv) {
  return waymark::RunTaskTool(argc, argv);
}
