// A process class with its type erased, so that one runner serves all.
#pragma once

#include "processes/support/bus.h"
#include "processes/support/configuration.h"

#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace waymark {

// A constructed process.
class RunningProcess {
 public:
  virtual ~RunningProcess() = default;
  // After the last message, before the bus flushes.
  virtual void Finish() = 0;
};

// The configuration of one process, and from it the process.
class ProcessSetup {
 public:
  virtual ~ProcessSetup() = default;
  // Defaults, file (none where empty), settings, check. Throws InputError.
  virtual void Load(const std::string& path,
                    const std::vector<std::string>& settings) = 0;
  // That the files which it names can be used. Throws InputError.
  virtual void CheckFiles() const = 0;
  virtual void Describe(Describer& d) = 0;
  [[nodiscard]] virtual std::unique_ptr<RunningProcess> Construct(
      Bus* bus) const = 0;
};

struct ProcessClass {
  std::string name;  // procman's, the executable's and the folder's.
  std::function<std::unique_ptr<ProcessSetup>()> make_setup;
  bool is_live_only = false;  // Drives a device: there is no offline run.
  std::string about;          // For --help: what it does, from which channels
                              // to which.
};

// P has a nested type Config with Describe(Describer&) and, if it wants one,
// Check() const and CheckFiles() const; a constant kName; a constructor (const
// Config&, Bus*); and if it wants one, Finish(). A constant kIsLiveOnly = true
// says that it drives a device, a text kAbout what it does.
template <typename P>
[[nodiscard]] ProcessClass MakeProcessClass() {
  class Running final : public RunningProcess {
   public:
    Running(const typename P::Config& config, Bus* bus)
        : process_(config, bus) {}
    void Finish() override {
      if constexpr (requires(P & p) { p.Finish(); }) process_.Finish();
    }

   private:
    P process_;
  };
  class Setup final : public ProcessSetup {
   public:
    void Load(const std::string& path,
              const std::vector<std::string>& settings) override {
      LoadConfiguration(path, settings, &config_);
    }
    void CheckFiles() const override {
      if constexpr (requires(const typename P::Config& c) { c.CheckFiles(); }) {
        config_.CheckFiles();
      }
    }
    void Describe(Describer& d) override { config_.Describe(d); }
    [[nodiscard]] std::unique_ptr<RunningProcess> Construct(
        Bus* bus) const override {
      return std::make_unique<Running>(config_, bus);
    }

   private:
    typename P::Config config_;
  };
  ProcessClass process_class{std::string(P::kName),
                             [] { return std::make_unique<Setup>(); },
                             false,
                             {}};
  process_class.is_live_only = requires {
    requires P::kIsLiveOnly;
  };
  if constexpr (requires { P::kAbout; }) process_class.about = P::kAbout;
  return process_class;
}

}  // namespace waymark
