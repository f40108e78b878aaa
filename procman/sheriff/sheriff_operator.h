// What an operator asks of a sheriff, step by step, with ends that can be
// waited for.
#pragma once

#include "procman/deployment/deployment_types.h"
#include "procman/sheriff/sheriff_link.h"

#include <functional>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

namespace waymark {

// One line: what was not reached.
class SheriffTimeout : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

class SheriffOperator {
 public:
  // Each wait of a script without a time of its own takes at most `timeout_s`.
  // `say` gets a line of what is done.
  SheriffOperator(SheriffLink* link,
                  const Deployment& deployment,
                  double timeout_s,
                  std::function<void(const std::string&)> say);

  // Ids of what is meant, in order. Throws std::invalid_argument where there is
  // none.
  [[nodiscard]] std::vector<std::string> Named(
      const ScriptTarget& target) const;

  // With all that they depend on, each once what it depends on is ready. What
  // runs goes on, but for kRestart. All throw SheriffTimeout, and
  // std::logic_error where another sheriff gives orders.
  void Start(const std::vector<std::string>& ids, StartStopAction::Kind kind);
  void Stop(const std::vector<std::string>& ids);
  void Wait(const std::vector<std::string>& ids,
            WaitFor wait,
            double timeout_s);
  void Run(const DeploymentScript& script);

 private:
  [[nodiscard]] bool Is(const std::string& id, WaitFor wait) const;
  [[nodiscard]] std::vector<std::string> WithDependencies(
      const std::vector<std::string>& ids) const;

  SheriffLink* link_;
  const Deployment& deployment_;
  double timeout_s_;
  std::function<void(const std::string&)> say_;
  bool gives_orders_ = false;
  std::map<std::string, Duration> ordered_;  // When each was started.
};

}  // namespace waymark
