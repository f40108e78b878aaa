// STATUS and CONFIG of one process.
#pragma once

#include "estimation/base/time.h"
#include "processes/support/counting_bus.h"

#include <cstdint>
#include <optional>
#include <string>

namespace waymark {

// Publishes STATUS once a second and CONFIG at the start and every ten
// seconds, of whatever clock the caller reads: steady live, event time offline.
// A clock that jumps back or far ahead causes one report, not many or none.
class StatusReporter {
 public:
  // `yaml`: the resolved configuration. `bus` must outlive this.
  StatusReporter(CountingBus* bus, std::string yaml);

  // Publishes what is due at `now`. Offline, messages carry `now` as utime;
  // live, what the bus knows of event time.
  void Report(Duration now);
  // Publishes STATUS whether or not it is due: the final counts.
  void ReportStatus(Duration now);

  // When STATUS is due next.
  [[nodiscard]] std::optional<Duration> next_status() const;

 private:
  void ReportConfiguration(Duration now);

  CountingBus* bus_;
  std::string yaml_;
  std::optional<Duration> last_status_;
  std::optional<Duration> last_configuration_;
  std::int32_t status_seq_ = 0;
  std::int32_t configuration_seq_ = 0;
};

}  // namespace waymark
