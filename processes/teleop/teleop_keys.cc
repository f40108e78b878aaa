#include "processes/teleop/teleop_keys.h"

#include <algorithm>
#include <cctype>

namespace waymark {
namespace {

constexpr double kShareStep = 0.1;
constexpr char kEscape = '\x1b';

}  // namespace

TeleopKeys::TeleopKeys(const TeleopConfig& config)
    : config_(config), share_(config.share) {}

void TeleopKeys::Drive(Time now, double forward, double turn) {
  const Velocity wanted{forward, turn};
  is_repeated_ = pressed_ && now >= *pressed_ && wanted == wanted_ &&
                 now - *pressed_ <= DurationFromSeconds(config_.hold_s);
  pressed_ = now;
  wanted_ = wanted;
}

std::optional<KeyEvent> TeleopKeys::Type(Time now, std::string_view bytes) {
  std::optional<KeyEvent> event;
  for (const char c : bytes) {
    if (c == kEscape) {
      escape_ = c;
      continue;
    }
    if (escape_.size() == 1 && (c == '[' || c == 'O')) {
      escape_ += c;
      continue;
    }
    std::optional<KeyEvent> now_asked;
    if (escape_.size() == 2) {
      // Numbers may come before the letter: modifier keys.
      if (std::isdigit(static_cast<unsigned char>(c)) != 0 || c == ';') {
        continue;
      }
      escape_.clear();
      constexpr std::string_view kArrows = "ABDC";
      constexpr std::string_view kLetters = "wsad";
      const std::size_t at = kArrows.find(c);
      now_asked = Key(now, at < kLetters.size() ? kLetters[at] : '\0');
    } else {
      escape_.clear();
      now_asked = Key(now, c);
    }
    if (now_asked && event != KeyEvent::kStop) event = now_asked;
  }
  return event;
}

std::optional<KeyEvent> TeleopKeys::Key(Time now, char key) {
  switch (std::tolower(static_cast<unsigned char>(key))) {
    case 'w':
      Drive(now, 1.0, 0.0);
      break;
    case 's':
      Drive(now, -1.0, 0.0);
      break;
    case 'a':
      Drive(now, 0.0, 1.0);
      break;
    case 'd':
      Drive(now, 0.0, -1.0);
      break;
    case 'q':
      Drive(now, 1.0, 0.5);
      break;
    case 'e':
      Drive(now, 1.0, -0.5);
      break;
    case '+':
    case '=':
      share_ = std::min(1.0, share_ + kShareStep);
      break;
    case '-':
      share_ = std::max(kShareStep, share_ - kShareStep);
      break;
    case ' ':
      pressed_.reset();
      return KeyEvent::kStop;
    case 'g':
      pressed_.reset();
      return KeyEvent::kGo;
    default:
      pressed_.reset();
  }
  return std::nullopt;
}

Velocity TeleopKeys::At(Time now) const {
  const double hold_s = is_repeated_ ? config_.hold_s : config_.first_hold_s;
  if (!pressed_ || now < *pressed_ ||
      now - *pressed_ > DurationFromSeconds(hold_s)) {
    return {};
  }
  return {share_ * config_.max_speed * wanted_.forward,
          share_ * config_.max_turn_rate * wanted_.turn_rate};
}

}  // namespace waymark
