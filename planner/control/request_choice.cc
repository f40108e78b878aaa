#include "planner/control/request_choice.h"

#include <algorithm>
#include <utility>

namespace waymark {

RequestChoice::RequestChoice(Duration timeout, std::string preferred)
    : timeout_(timeout), preferred_(std::move(preferred)) {}

void RequestChoice::Forget(Time now) {
  std::erase_if(requests_, [&](const MotionRequest& request) {
    return request.arrival > now || now - request.arrival > timeout_;
  });
}

void RequestChoice::Set(const MotionRequest& request) {
  Forget(request.arrival);
  std::erase_if(requests_, [&](const MotionRequest& other) {
    return other.source == request.source;
  });
  requests_.push_back(request);
}

std::optional<MotionRequest> RequestChoice::Choose(Time now) {
  Forget(now);
  const MotionRequest* chosen = nullptr;
  const auto rank = [&](const MotionRequest& request) {
    return request.source == preferred_ ? 2 : request.source == holder_ ? 1 : 0;
  };
  for (const MotionRequest& request : requests_) {
    if (request.velocity.is_zero()) continue;
    if (chosen == nullptr || rank(request) >= rank(*chosen)) chosen = &request;
  }
  holder_ = chosen == nullptr ? "" : chosen->source;
  if (chosen != nullptr) return *chosen;
  if (requests_.empty()) return std::nullopt;
  return requests_.back();
}

}  // namespace waymark
