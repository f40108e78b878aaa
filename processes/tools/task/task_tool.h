// waymark-task: tells a robot what to do.
#pragma once

namespace waymark {

// waymark-task waypoints X,Y[,DEG]...   drive there, on POSE
// waymark-task tour X,Y[,DEG]...        the same on TRUTH
// waymark-task corridor CORRIDOR        to and fro in a corridor, on POSE
// waymark-task cancel                   give up what is under way
// waymark-task stop | go                latch STOP, let go
//
// Returns once somebody has taken it up; with --follow once it is done, with
// its progress on stdout. Exit code 0; 1 and one line where nobody answers
// within --timeout, or the task failed or was given up; 2 where flags or
// network cannot be used.
int RunTaskTool(int argc, char** argv);

}  // namespace waymark
