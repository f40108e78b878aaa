#include "processes/tools/task/talk.h"

#include "estimation/base/input_error.h"
#include "processes/support/lcm_url.h"

#include <stdexcept>

namespace waymark {
namespace {

constexpr std::chrono::milliseconds kLook{50};  // How late an answer is seen.

}  // namespace

Talk::Talk(const std::string& asked_url, double timeout_s)
    : timeout_s_(timeout_s) {
  const std::string url = WithGrantedBuffer(LcmUrl(asked_url));
  CheckLcmReachable(url);
  lcm_ = std::make_unique<lcm::LCM>(url);
  if (!lcm_->good()) throw InputError("LCM cannot be created with " + url);
}

void Talk::Look() {
  if (lcm_->handleTimeout(static_cast<int>(kLook.count())) < 0) {
    throw std::runtime_error("LCM stopped working");
  }
}

void Talk::OnMessage(const lcm::ReceiveBuffer* buffer,
                     const std::string& channel) {
  for (std::size_t i = 0; i < channels_.size(); ++i) {
    if (channels_[i] != channel) continue;
    handlers_[i](
        {static_cast<const std::uint8_t*>(buffer->data), buffer->data_size});
  }
}

}  // namespace waymark
