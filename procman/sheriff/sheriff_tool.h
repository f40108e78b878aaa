// waymark-sheriff: commands deputies over LCM, for scripts and people.
#pragma once

namespace waymark {

// Exit code 0; 1 and one line where something was not reached in time, a
// command failed to run, or another sheriff gives orders; 2 and one line where
// flags, the file or the network cannot be used.
int RunSheriffTool(int argc, char** argv);

}  // namespace waymark
