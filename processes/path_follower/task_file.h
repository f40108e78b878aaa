// A task on disk, so that it goes on after a restart.
#pragma once

#include "processes/convert/task_convert.h"

#include <optional>
#include <string>

namespace waymark {

struct TaskProgress {
  Task task;
  Time time;  // Of the pose by which it was that far.
  int num_reached = 0;
};

// nullopt where there is no such file, or it says that nothing is under way.
// Throws InputError with one line where it cannot be read or is no such file.
[[nodiscard]] std::optional<TaskProgress> LoadTaskFile(const std::string& path);

// What LoadTaskFile() reads; nullopt: nothing is under way.
[[nodiscard]] std::string TextOfTask(
    const std::optional<TaskProgress>& progress);

}  // namespace waymark
