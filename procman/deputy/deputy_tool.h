// waymark-deputy: runs a host's commands as a sheriff orders.
#pragma once

namespace waymark {

// Exit code 0; 1 where LCM stops working; 2 and one line where flags, the file
// or the network cannot be used, or another deputy of the same id is there.
int RunDeputyTool(int argc, char** argv);

}  // namespace waymark
