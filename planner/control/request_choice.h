// Which of several that ask for motion gets it.
#pragma once

#include "estimation/base/time.h"
#include "planner/control/drive_model.h"

#include <optional>
#include <string>
#include <vector>

namespace waymark {

struct MotionRequest {
  Time time;     // Its own time stamp.
  Time arrival;  // On the clock of who chooses.
  std::string source;
  Velocity velocity;
  std::string reason;
};

// Whoever asks for 0 leaves the wheels to others. Of those that ask for motion
// the preferred source comes first, then the one that has had them, then the
// one that asked last.
class RequestChoice {
 public:
  // A request counts for `timeout` from its arrival.
  RequestChoice(Duration timeout, std::string preferred);

  // Replaces the one of the same source.
  void Set(const MotionRequest& request);

  // nullopt where all are too old. Time that goes back forgets all later ones.
  [[nodiscard]] std::optional<MotionRequest> Choose(Time now);

 private:
  void Forget(Time now);

  Duration timeout_;
  std::string preferred_;
  std::string holder_;                   // Empty: nobody.
  std::vector<MotionRequest> requests_;  // In the order of arrival.
};

}  // namespace waymark
