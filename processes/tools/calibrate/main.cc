#include "processes/tools/calibrate/calibrate_tool.h"

int main(int argc, char** argv) {
  return waymark::RunCalibrateTool(argc, argv);
}
