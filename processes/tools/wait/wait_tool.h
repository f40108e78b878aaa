// waymark-wait: lets a script wait for what happens on the bus.
#pragma once

namespace waymark {

// waymark-wait status NAME...   returns once each process was seen on STATUS
// waymark-wait idle --for S     returns once no message came for S seconds
//                               (STATUS and CONFIG, which never stop, aside)
//
// Exit code 0; 1 and one line that says what is still missing where --timeout
// passes first; 2 where flags or network cannot be used.
int RunWaitTool(int argc, char** argv);

}  // namespace waymark
