#include "processes/tools/refine/refine_tool.h"

int main(int argc, char** argv) {
  return waymark::RunRefineTool(argc, argv);
}
