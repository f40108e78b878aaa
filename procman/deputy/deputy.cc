#include "procman/deputy/deputy.h"

#include "estimation/base/input_error.h"
#include "processes/support/decode.h"
#include "processes/support/lcm_url.h"

#include <poll.h>
#include <procman_lcm/output_t.hpp>
#include <sys/signalfd.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <span>
#include <stdexcept>
#include <utility>
#include <variant>
#include <vector>

namespace waymark {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr char kInfo[] = "PM_INFO";
constexpr char kOrders[] = "PM_ORDERS";
constexpr char kOutput[] = "PM_OUTPUT";
constexpr char kDiscover[] = "PM_DISCOVER";

// Another deputy of this id has answered by then.
constexpr Duration kWindow = milliseconds(500);
constexpr Duration kDiscoverPeriod = milliseconds(200);
constexpr Duration kInfoPeriod = seconds(1);
// At a time, of one command: others print, too, and orders must be heard.
constexpr int kMostReads = 16;

Duration Now() {
  return std::chrono::duration_cast<Duration>(
      std::chrono::steady_clock::now().time_since_epoch());
}

Time Wall() {
  return Time(std::chrono::duration_cast<Duration>(
      std::chrono::system_clock::now().time_since_epoch()));
}

template <typename M>
std::optional<M> MessageOf(const lcm::ReceiveBuffer* buffer) {
  return DecodeMessage<M>(
      {static_cast<const std::uint8_t*>(buffer->data), buffer->data_size});
}

std::optional<std::string> Variable(std::string_view name) {
  const char* value = std::getenv(std::string(name).c_str());
  return value == nullptr ? std::nullopt : std::optional<std::string>(value);
}

template <typename... Functions>
struct Overloaded : Functions... {
  using Functions::operator()...;
};
template <typename... Functions>
Overloaded(Functions...) -> Overloaded<Functions...>;

int MakeSignals() {
  sigset_t set;
  sigemptyset(&set);
  for (const int signal : {SIGCHLD, SIGINT, SIGTERM, SIGHUP, SIGQUIT}) {
    sigaddset(&set, signal);
  }
  sigprocmask(SIG_BLOCK, &set, nullptr);
  return signalfd(-1, &set, SFD_NONBLOCK | SFD_CLOEXEC);
}

}  // namespace

Deputy::Deputy(const DeputyOptions& options)
    : options_(options),
      state_({options.id,
              DeputyDialect::kProcman,
              [this](const CommandSpec& spec) { return WhyRefused(spec); }}),
      gate_(options.output) {
  AdoptOrphans();
  // Before LCM makes its thread, which must not take them.
  signals_ = MakeSignals();
  const std::string url = WithGrantedBuffer(LcmUrl(options.lcm_url));
  CheckLcmReachable(url);
  lcm_ = std::make_unique<lcm::LCM>(url);
  if (!lcm_->good()) throw InputError("LCM cannot be created with " + url);
  lcm_->subscribe(kInfo, &Deputy::OnInfo, this);
  lcm_->subscribe(kDiscover, &Deputy::OnDiscover, this);
  lcm_->subscribe(kOrders, &Deputy::OnOrders, this);
}

Deputy::~Deputy() {
  for (auto& [id, terminal] : terminals_) close(terminal.fd);
  if (signals_ >= 0) close(signals_);
}

std::string Deputy::WhyRefused(const CommandSpec& spec) const {
  if (!options_.deployment) return {};
  const DeploymentCommand* known = options_.deployment->Find(spec.id);
  if (known == nullptr || known->deputy != options_.id) {
    return "the deployment file of " + options_.id + " has no command \"" +
           spec.id + "\"";
  }
  if (known->exec != spec.exec) {
    return "the deployment file of " + options_.id +
           " has another exec for \"" + spec.id + "\"";
  }
  return {};
}

// ---- messages
// ----------------------------------------------------------------

void Deputy::OnInfo(const lcm::ReceiveBuffer* buffer, const std::string&) {
  if (is_open_) return;
  const auto info = MessageOf<procman_lcm::deputy_info_t>(buffer);
  if (info && info->deputy_id == options_.id) has_conflict_ = true;
}

void Deputy::OnDiscover(const lcm::ReceiveBuffer* buffer, const std::string&) {
  const auto discovery = MessageOf<procman_lcm::discovery_t>(buffer);
  if (!discovery) return;
  if (is_open_) {
    is_info_due_ = true;
  } else if (discovery->transmitter_id == options_.id &&
             discovery->nonce != getpid()) {
    has_conflict_ = true;
  }
}

void Deputy::OnOrders(const lcm::ReceiveBuffer* buffer, const std::string&) {
  if (!is_open_) return;
  const auto orders = MessageOf<procman_lcm::orders_t>(buffer);
  if (orders) Do(state_.OnOrders(ToOrders(*orders), Wall(), Now()));
}

void Deputy::PublishDiscover() {
  procman_lcm::discovery_t message;
  message.utime = Microseconds(Wall());
  message.transmitter_id = options_.id;
  message.nonce = getpid();
  lcm_->publish(kDiscover, &message);
}

void Deputy::PublishInfo() {
  is_info_due_ = false;
  const auto message =
      ToInfo(options_.id, state_.commands(), uses_, memory_, cpu_load_, Wall());
  lcm_->publish(kInfo, &message);
}

void Deputy::PublishOutput() {
  const auto texts = gate_.Take(Now());
  if (texts.empty()) return;
  procman_lcm::output_t message;
  message.utime = Microseconds(Wall());
  message.deputy_id = options_.id;
  for (const OutputText& text : texts) {
    message.command_ids.push_back(text.command_id);
    message.text.push_back(text.text);
  }
  message.num_commands = static_cast<std::int16_t>(texts.size());
  lcm_->publish(kOutput, &message);
}

// ---- children
// ----------------------------------------------------------------

void Deputy::Do(const DeputyState::Actions& actions) {
  for (const DeputyAction& action : actions) {
    std::visit(
        Overloaded{
            [this](const StartChild& start) { Start(start.id); },
            [](const SignalFamily& signal) {
              SignalFamilyOf(signal.pid, signal.id, signal.signal);
            },
            [](const EndFamily& end) { KillLeftFamily(end.pid, end.id); },
            [this](const SayText& say) { Say(say.id, say.text); },
            [this](const waymark::PublishInfo&) { is_info_due_ = true; }},
        action);
  }
}

void Deputy::Say(const std::string& id, const std::string& text) {
  gate_.Add(id, text, Now());
}

void Deputy::Start(const std::string& id) {
  const CommandSpec spec = state_.commands().at(id).spec;
  CloseTerminal(id);
  ChildOptions child_options;
  child_options.id = id;
  try {
    child_options.exec = SplitExec(spec.exec, Variable);
  } catch (const std::invalid_argument& e) {
    Do(state_.OnStartFailed(id, e.what(), Now()));
    return;
  }
  if (options_.deployment) {
    if (const auto* known = options_.deployment->Find(id)) {
      constexpr std::int64_t kMib = 1 << 20;
      child_options.working_dir = known->working_dir;
      child_options.nice = known->nice;
      child_options.memory_bytes = kMib * known->memory_limit_mb;
      child_options.max_processes = known->max_processes;
    }
  }
  const Child child = SpawnChild(child_options);
  if (child.pid == 0) {
    Do(state_.OnStartFailed(id, child.error, Now()));
    return;
  }
  // One that ends before its program runs is reaped like any other.
  if (!child.error.empty()) Say(id, child.error + "\n");
  terminals_[id].fd = child.terminal;
  measured_.erase(id);
  uses_.erase(id);
  Do(state_.OnStarted(id, child.pid, Now()));
}

void Deputy::Read(const std::string& id) {
  Terminal& terminal = terminals_.at(id);
  std::array<char, 16384> bytes;
  for (int i = 0; i < kMostReads; ++i) {
    const ssize_t num = read(terminal.fd, bytes.data(), bytes.size());
    if (num > 0) {
      Say(id,
          terminal.clean.Add({bytes.data(), static_cast<std::size_t>(num)}));
      continue;
    }
    // EIO: nobody has the other side open any longer.
    if (num < 0 && (errno == EAGAIN || errno == EINTR)) return;
    CloseTerminal(id);
    return;
  }
}

void Deputy::CloseTerminal(const std::string& id) {
  const auto found = terminals_.find(id);
  if (found == terminals_.end()) return;
  Say(id, found->second.clean.Finish());
  close(found->second.fd);
  terminals_.erase(found);
}

void Deputy::Reap() {
  int status = 0;
  pid_t pid = 0;
  while ((pid = waitpid(-1, &status, WNOHANG)) > 0) {
    for (const auto& [id, command] : state_.commands()) {
      if (command.pid != pid) continue;
      // Its last words before anything that is said of it.
      if (terminals_.count(id) != 0) Read(id);
      if (WIFSIGNALED(status)) {
        Say(id, std::string(strsignal(WTERMSIG(status))) + "\n");
        if (WCOREDUMP(status)) Say(id, "Core dumped.\n");
      }
      break;
    }
    Do(state_.OnExit(pid, status, Now()));
  }
}

void Deputy::Measure(Duration now) {
  const auto machine = ParseMachineTicks(ReadKernelFile("/proc/stat"));
  const MachineTicks before = machine_.value_or(MachineTicks());
  std::uint64_t elapsed = 0;
  if (machine) {
    elapsed = machine->busy + machine->idle - before.busy - before.idle;
    if (elapsed > 0) {
      cpu_load_ = static_cast<double>(machine->busy - before.busy) /
                  static_cast<double>(elapsed);
    }
    machine_ = machine;
  }
  memory_ = ParseMachineMemory(ReadKernelFile("/proc/meminfo"));
  const auto processes = ReadProcesses();
  const auto page = static_cast<std::int64_t>(sysconf(_SC_PAGESIZE));
  for (const auto& [id, command] : state_.commands()) {
    if (!command.is_running()) continue;
    auto family = DescendantsOf(command.pid, processes);
    for (const ProcessStat& process : processes) {
      if (process.pid == command.pid) family.push_back(process);
    }
    CommandUse use;
    std::uint64_t ticks = 0;
    for (const ProcessStat& process : family) {
      ticks += process.user_ticks + process.system_ticks;
      use.virtual_bytes += static_cast<std::int64_t>(process.virtual_bytes);
      use.resident_bytes += page * process.resident_pages;
    }
    const auto last = measured_.find(id);
    // What has ended meanwhile takes its ticks along.
    if (last != measured_.end() && ticks > last->second.ticks && elapsed > 0) {
      use.cpu_share = static_cast<double>(ticks - last->second.ticks) /
                      static_cast<double>(elapsed);
    }
    measured_[id] = {now, ticks};
    uses_[id] = use;
  }
}

// ---- the loop
// ----------------------------------------------------------------

void Deputy::Wait(Duration until) {
  std::vector<pollfd> files{{lcm_->getFileno(), POLLIN, 0},
                            {signals_, POLLIN, 0}};
  std::vector<std::string> ids;
  for (const auto& [id, terminal] : terminals_) {
    files.push_back({terminal.fd, POLLIN, 0});
    ids.push_back(id);
  }
  const auto wait =
      std::chrono::ceil<milliseconds>(std::max(Duration(0), until - Now()));
  if (poll(files.data(), files.size(), static_cast<int>(wait.count())) <= 0) {
    return;
  }
  if ((files[0].revents & POLLIN) != 0 && lcm_->handle() != 0) {
    throw std::runtime_error("LCM stopped working");
  }
  for (std::size_t i = 0; i < ids.size(); ++i) {
    // It may have been started anew meanwhile.
    const auto found = terminals_.find(ids[i]);
    if (files[i + 2].revents != 0 && found != terminals_.end() &&
        found->second.fd == files[i + 2].fd) {
      Read(ids[i]);
    }
  }
  signalfd_siginfo signal{};
  while (read(signals_, &signal, sizeof(signal)) ==
         static_cast<ssize_t>(sizeof(signal))) {
    if (signal.ssi_signo != SIGCHLD && !is_asked_to_end_) {
      is_asked_to_end_ = true;
      Do(state_.OnQuit(Now()));
    }
  }
  Reap();
}

int Deputy::Run() {
  const Duration begin = Now();
  Duration next_discover = begin;
  Duration next_info = begin + kWindow;
  while (!(is_asked_to_end_ && state_.is_done())) {
    Duration now = Now();
    if (has_conflict_) return 2;
    if (!is_open_) {
      if (is_asked_to_end_) return 0;
      if (now >= begin + kWindow) {
        is_open_ = true;
      } else if (now >= next_discover) {
        PublishDiscover();
        next_discover += kDiscoverPeriod;
      }
    }
    Do(state_.OnTimer(now));
    if (is_open_ && now >= next_info) {
      Measure(now);
      is_info_due_ = true;
      // Not as often as were missed while the machine stood still.
      next_info = std::max(next_info + kInfoPeriod, now);
    }
    if (is_open_ && is_info_due_) PublishInfo();
    PublishOutput();
    Duration until = is_open_ ? next_info : std::min(next_discover, next_info);
    for (const auto& due : {state_.next_timer(), gate_.next()}) {
      if (due) until = std::min(until, *due);
    }
    Wait(until);
  }
  // Their last words, and that they have ended.
  PublishInfo();
  for (int i = 0; i < 3 && gate_.next(); ++i) {
    Wait(*gate_.next());
    PublishOutput();
  }
  return 0;
}

}  // namespace waymark
