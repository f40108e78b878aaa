#include "processes/tools/world/world_tool.h"

int main(int argc, char** argv) {
  return waymark::RunWorldTool(argc, argv);
}
