// Key strokes to what a person wants.
#pragma once

#include "estimation/base/time.h"
#include "planner/control/drive_model.h"
#include "processes/teleop/teleop_config.h"

#include <optional>
#include <string>
#include <string_view>

namespace waymark {

// What a stroke asks for besides motion.
enum class KeyEvent { kStop, kGo };

// Arrows, w a s d: forward, left, back, right; q e: forward on a curve. + -:
// faster, slower. Space: stop, g: let go. Any other key: stand.
class TeleopKeys {
 public:
  explicit TeleopKeys(const TeleopConfig& config);

  // Bytes as a terminal sends them; an arrow may come in parts. Returns the
  // last stop or let-go among them, a stop before all others.
  [[nodiscard]] std::optional<KeyEvent> Type(Time now, std::string_view bytes);

  // Zero once the last stroke is older than hold_s, or first_hold_s where it
  // was not repeated yet: who lets go, or falls off the chair, stops the robot.
  [[nodiscard]] Velocity At(Time now) const;
  [[nodiscard]] double share() const { return share_; }

 private:
  void Drive(Time now, double forward, double turn);
  [[nodiscard]] std::optional<KeyEvent> Key(Time now, char key);

  TeleopConfig config_;
  double share_;
  std::string escape_;  // The beginning of a longer code.
  std::optional<Time> pressed_;
  bool is_repeated_ = false;  // The last stroke: not the first of its key.
  Velocity wanted_;           // Shares of full speed.
};

}  // namespace waymark
