#include "processes/support/status_reporter.h"

#include "processes/support/channels.h"

#include <waymark/config_t.hpp>
#include <waymark/status_t.hpp>

#include <utility>

namespace waymark {
namespace {

constexpr Duration kStatusPeriod = std::chrono::seconds(1);
constexpr Duration kConfigurationPeriod = std::chrono::seconds(10);

bool IsDue(std::optional<Duration> last, Duration period, Duration now) {
  // Compared without a sum or difference, which could overflow where a log's
  // times are damaged.
  return !last || now < *last ||
         now.count() / 2 - last->count() / 2 >= period.count() / 2;
}

}  // namespace

StatusReporter::StatusReporter(CountingBus* bus, std::string yaml)
    : bus_(bus), yaml_(std::move(yaml)) {}

void StatusReporter::Report(Duration now) {
  if (IsDue(last_configuration_, kConfigurationPeriod, now)) {
    ReportConfiguration(now);
  }
  if (IsDue(last_status_, kStatusPeriod, now)) ReportStatus(now);
}

void StatusReporter::ReportConfiguration(Duration now) {
  last_configuration_ = now;
  config_t message;
  message.utime = bus_->is_offline() ? now.count() : bus_->event_utime();
  message.seq = configuration_seq_++;
  message.process = bus_->process();
  message.version = WAYMARK_VERSION;
  message.yaml = yaml_;
  bus_->Publish(kConfig, message);
}

void StatusReporter::ReportStatus(Duration now) {
  last_status_ = now;
  status_t message = bus_->MakeStatus();
  if (bus_->is_offline()) message.utime = now.count();
  message.seq = status_seq_++;
  bus_->Publish(kStatus, message);
}

std::optional<Duration> StatusReporter::next_status() const {
  if (!last_status_) return std::nullopt;
  return *last_status_ + kStatusPeriod;
}

}  // namespace waymark
