// Work on the rows of an image by several threads.
#pragma once

#include <functional>

namespace waymark {

// Calls `work(row)` once for each row in [0, num_rows), in no particular order,
// by `num_threads` threads, the caller's among them; returns when all are
// done. An exception that leaves `work` is thrown again here; the rows not yet
// begun are then left out. The result is independent of `num_threads` where
// rows do not touch each other's.
void ForEachRow(int num_rows,
                int num_threads,
                const std::function<void(int row)>& work);

}  // namespace waymark
