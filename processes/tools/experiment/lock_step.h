// Process classes around a simulator, in one thread and simulated time.
#pragma once

#include "estimation/base/time.h"
#include "estimation/geometry/pose2.h"
#include "processes/support/local_bus.h"
#include "processes/support/log_file.h"
#include "processes/support/process_class.h"

#include <waymark/task_status_t.hpp>

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace waymark {

// What a run has come to so far, from its messages.
struct Trip {
  double way_m = 0.0;                  // Of TRUTH.
  std::optional<Pose2> X_WR;           // The last TRUTH.
  std::int64_t num_touches = 0;        // Of BASE.
  std::optional<task_status_t> task;   // The last TASK_STATUS.
  double max_pose_error_m = 0.0;       // Of POSE against TRUTH of its time.
  std::optional<double> pose_error_m;  // The last.
};

class LockStep {
 public:
  // Writes every message to `log_path`, replaced where it is there, unless that
  // is empty.
  LockStep(Time start, const std::string& log_path);

  // In the order in which they handle what comes at the same time.
  template <typename P>
  void Add(const typename P::Config& config,
           Duration handler_latency = Duration(0)) {
    class Running final : public RunningProcess {
     public:
      Running(const typename P::Config& own, Bus* bus) : process_(own, bus) {}
      void Finish() override {
        if constexpr (requires(P & p) { p.Finish(); }) process_.Finish();
      }

     private:
      P process_;
    };
    processes_.push_back(std::make_unique<Running>(
        config, bus_.AddProcess(std::string(P::kName), handler_latency)));
  }

  [[nodiscard]] LocalBus* bus() { return &bus_; }

  // Runs until is_over(), which is asked every 50 ms of simulated time, or so
  // long after the start; false for the latter. Called once.
  [[nodiscard]] bool Run(const std::function<bool(const Trip&)>& is_over,
                         Duration limit);

  [[nodiscard]] const Trip& trip() const { return trip_; }
  [[nodiscard]] double duration_s() const;

 private:
  void Note(const RawMessage& message);

  Time start_;
  std::unique_ptr<LogWriter> log_;
  LocalBus bus_;
  std::vector<std::unique_ptr<RunningProcess>> processes_;
  Trip trip_;
  std::int64_t truth_utime_ = 0;
};

}  // namespace waymark
