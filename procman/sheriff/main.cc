#include "procman/sheriff/sheriff_tool.h"

int main(int argc, char** argv) {
  return waymark::RunSheriffTool(argc, argv);
}
