#include "processes/tools/replay/known_processes.h"
#include "processes/tools/replay/replay_tool.h"

int main(int argc, char** argv) {
  return waymark::RunReplayTool(waymark::KnownProcesses(), argc, argv);
}
