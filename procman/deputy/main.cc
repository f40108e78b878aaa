#include "procman/deputy/deputy_tool.h"

int main(int argc, char** argv) {
  return waymark::RunDeputyTool(argc, argv);
}
