#include "processes/support/configuration.h"

#include "processes/support/configuration_range.h"

#include <spdlog/fmt/fmt.h>
#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstring>
#include <fstream>
#include <optional>
#include <set>
#include <sstream>
#include <system_error>

namespace waymark {
namespace {

template <typename T>
std::optional<T> ParseWhole(const std::string& text) {
  // from_chars knows no leading plus; YAML does.
  const char* begin = text.data();
  const char* end = begin + text.size();
  if (begin != end && *begin == '+') ++begin;
  T value{};
  const auto [rest, error] = std::from_chars(begin, end, value);
  if (error != std::errc() || rest != end) return std::nullopt;
  return value;
}

// Takes what the parser reports and keeps nothing.
class IgnoringHandler final : public YAML::EventHandler {
 public:
  void OnDocumentStart(const YAML::Mark& /*mark*/) override {}
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark& /*mark*/, YAML::anchor_t /*anchor*/) override {}
  void OnAlias(const YAML::Mark& /*mark*/, YAML::anchor_t /*anchor*/) override {
  }
  void OnScalar(const YAML::Mark& /*mark*/,
                const std::string& /*tag*/,
                YAML::anchor_t /*anchor*/,
                const std::string& /*value*/) override {}
  void OnSequenceStart(const YAML::Mark& /*mark*/,
                       const std::string& /*tag*/,
                       YAML::anchor_t /*anchor*/,
                       YAML::EmitterStyle::value /*style*/) override {}
  void OnSequenceEnd() override {}
  void OnMapStart(const YAML::Mark& /*mark*/,
                  const std::string& /*tag*/,
                  YAML::anchor_t /*anchor*/,
                  YAML::EmitterStyle::value /*style*/) override {}
  void OnMapEnd() override {}
};

// The one document in `text`, null where there is none. Documents are counted
// first, and not further than two: text such as ",a" makes yaml-cpp 0.7 report
// documents without end, and its LoadAll() takes memory for each.
YAML::Node LoadDocument(const std::string& text, const std::string& name) {
  std::istringstream stream(text);
  YAML::Parser parser(stream);
  IgnoringHandler handler;
  for (int count = 0; parser.HandleNextDocument(handler); ++count) {
    if (count == 1) throw InputError(name + ": must be one YAML document");
  }
  return YAML::Load(text);
}

// Sets fields from one YAML document.
class Loader final : public Describer {
 public:
  Loader(const YAML::Node& root, std::string source, bool has_lines)
      : source_(std::move(source)), has_lines_(has_lines) {
    Enter(root);
  }

  void Finish() { Leave(); }

  void Number(std::string_view key,
              double* value,
              Range range,
              std::string_view /*help*/) override {
    const std::optional<YAML::Node> node = Take(key);
    if (node) *value = ToNumber(*node, key, range);
  }
  void Degrees(std::string_view key,
               double* value_rad,
               Range range_deg,
               std::string_view /*help*/) override {
    const std::optional<YAML::Node> node = Take(key);
    if (node) {
      *value_rad = ToNumber(*node, key, range_deg) * kRadiansPerDegree;
    }
  }
  void Integer(std::string_view key,
               std::int64_t* value,
               std::int64_t min,
               std::int64_t max,
               std::string_view /*help*/) override {
    const std::optional<YAML::Node> node = Take(key);
    if (!node) return;
    const auto parsed = IsPlain(*node)
                            ? ParseWhole<std::int64_t>(node->Scalar())
                            : std::nullopt;
    if (!parsed || *parsed < min || *parsed > max) {
      Refuse(*node, key, "must be a whole number" + IntegerRange(min, max));
    }
    *value = *parsed;
  }
  void Flag(std::string_view key,
            bool* value,
            std::string_view /*help*/) override {
    const std::optional<YAML::Node> node = Take(key);
    if (!node) return;
    const bool is_true = IsPlain(*node) && node->Scalar() == "true";
    if (!is_true && !(IsPlain(*node) && node->Scalar() == "false")) {
      Refuse(*node, key, "must be true or false");
    }
    *value = is_true;
  }
  void Text(std::string_view key,
            std::string* value,
            std::string_view /*help*/) override {
    const std::optional<YAML::Node> node = Take(key);
    if (!node) return;
    if (!node->IsScalar()) Refuse(*node, key, "must be text");
    *value = node->Scalar();
  }
  void Numbers(std::string_view key,
               std::vector<double>* values,
               int size,
               std::string_view /*help*/) override {
    const std::optional<YAML::Node> node = Take(key);
    if (!node) return;
    // An empty list stands for 'not given' only where that is the default.
    const bool size_fits =
        node->IsSequence() &&
        (size < 0 || node->size() == static_cast<std::size_t>(size) ||
         (node->size() == 0 && values->empty()));
    if (!size_fits) {
      Refuse(*node,
             key,
             size < 0 ? std::string("must be a list of numbers")
                      : fmt::format("must be a list of {} numbers", size));
    }
    std::vector<double> loaded;
    for (std::size_t i = 0; i < node->size(); ++i) {
      loaded.push_back(
          ToNumber((*node)[i], fmt::format("{}[{}]", key, i), Range{}));
    }
    *values = std::move(loaded);
  }
  void ChoiceIndex(std::string_view key,
                   int* index,
                   const std::vector<std::string>& names,
                   std::string_view /*help*/) override {
    const std::optional<YAML::Node> node = Take(key);
    if (!node) return;
    const auto found =
        node->IsScalar() ? std::find(names.begin(), names.end(), node->Scalar())
                         : names.end();
    if (found == names.end()) {
      Refuse(*node,
             key,
             fmt::format("must be one of: {}", fmt::join(names, ", ")));
    }
    *index = static_cast<int>(found - names.begin());
  }
  void Group(std::string_view key,
             const std::function<void()>& describe,
             std::string_view /*help*/) override {
    const std::optional<YAML::Node> node = Take(key);
    // Without a node the fields are visited all the same, to stay in step.
    YAML::Node inner(YAML::NodeType::Map);
    if (node && !node->IsNull()) {
      if (!node->IsMap()) Refuse(*node, key, "must be a group of keys");
      inner = *node;
    }
    prefix_.emplace_back(key);
    Enter(inner);
    describe();
    Leave();
    prefix_.pop_back();
  }

 private:
  struct Level {
    YAML::Node node;
    std::vector<std::string> known;
  };

  // Checks for keys given twice: yaml-cpp keeps both and finds the first.
  void Enter(const YAML::Node& node) {
    std::set<std::string> seen;
    for (const auto& entry : node) {
      if (!entry.first.IsScalar()) {
        throw InputError(Place(entry.first) + "a key must be a plain word");
      }
      if (!seen.insert(entry.first.Scalar()).second) {
        throw InputError(fmt::format("{}{}: given twice",
                                     Place(entry.first),
                                     FullKey(entry.first.Scalar())));
      }
    }
    levels_.push_back(Level{node, {}});
  }

  void Leave() {
    const Level& level = levels_.back();
    for (const auto& entry : level.node) {
      const std::string& key = entry.first.Scalar();
      if (std::find(level.known.begin(), level.known.end(), key) !=
          level.known.end()) {
        continue;
      }
      throw InputError(fmt::format("{}{}: unknown key; known here: {}",
                                   Place(entry.first),
                                   FullKey(key),
                                   fmt::join(level.known, ", ")));
    }
    levels_.pop_back();
  }

  std::optional<YAML::Node> Take(std::string_view key) {
    Level& level = levels_.back();
    level.known.emplace_back(key);
    for (const auto& entry : level.node) {
      if (entry.first.Scalar() != key) continue;
      key_line_ = entry.first.Mark().line;
      return entry.second;
    }
    return std::nullopt;
  }

  // A scalar without quotes; quotes make it text.
  static bool IsPlain(const YAML::Node& node) {
    return node.IsScalar() && node.Tag() != "!";
  }

  double ToNumber(const YAML::Node& node, std::string_view key, Range range) {
    const auto parsed =
        IsPlain(node) ? ParseWhole<double>(node.Scalar()) : std::nullopt;
    if (!parsed || !std::isfinite(*parsed) || *parsed < range.min ||
        *parsed > range.max) {
      Refuse(node, key, "must be a number" + NumberRange(range));
    }
    return *parsed;
  }

  [[noreturn]] void Refuse(const YAML::Node& node,
                           std::string_view key,
                           const std::string& allowed) const {
    std::string value;
    if (node.IsScalar()) {
      value = node.Tag() == "!" ? '"' + node.Scalar() + '"' : node.Scalar();
    } else if (node.IsSequence()) {
      value = fmt::format("a list of {}", node.size());
    } else {
      value = node.IsMap() ? "a group" : "nothing";
    }
    throw InputError(fmt::format(
        "{}{} = {}: {}", Place(node), FullKey(key), value, allowed));
  }

  std::string FullKey(std::string_view key) const {
    std::string full;
    for (const std::string& part : prefix_) full += part + '.';
    return full + std::string(key);
  }

  std::string Place(const YAML::Node& node) const {
    if (!has_lines_) return source_ + ": ";
    // Marks count from 0. An absent value has none of its own.
    const int line = node.IsNull() ? key_line_ : node.Mark().line;
    return fmt::format("{}:{}: ", source_, line + 1);
  }

  std::string source_;
  bool has_lines_;
  int key_line_ = 0;  // Of the key taken last.
  std::vector<Level> levels_;
  std::vector<std::string> prefix_;
};

void LoadNode(const YAML::Node& root,
              const std::string& source,
              bool has_lines,
              const DescribeFunction& describe) {
  if (!root.IsNull() && !root.IsMap()) {
    throw InputError(source + ": must be a list of 'key: value' lines");
  }
  Loader loader(root.IsNull() ? YAML::Node(YAML::NodeType::Map) : root,
                source,
                has_lines);
  describe(loader);
  loader.Finish();
}

}  // namespace

void LoadConfigurationText(std::string_view yaml,
                           std::string_view source,
                           const DescribeFunction& describe) {
  const std::string name(source);
  YAML::Node document;
  try {
    document = LoadDocument(std::string(yaml), name);
  } catch (const YAML::Exception& error) {
    throw InputError(
        fmt::format("{}:{}: {}", name, error.mark.line + 1, error.msg));
  }
  if (!document.IsNull()) LoadNode(document, name, true, describe);
}

void LoadConfigurationFile(const std::string& path,
                           const DescribeFunction& describe) {
  std::ifstream file(path, std::ios::binary);
  if (!file) {
    throw InputError(
        fmt::format("{}: cannot open: {}", path, std::strerror(errno)));
  }
  std::ostringstream text;
  // Copying sets badbit where reading fails, of a directory for example.
  if (file.peek() != std::ifstream::traits_type::eof()) text << file.rdbuf();
  if (file.bad() || !text) throw InputError(path + ": cannot read");
  LoadConfigurationText(text.str(), path, describe);
}

void ApplySetting(std::string_view setting, const DescribeFunction& describe) {
  const std::string source = fmt::format("--set {}", setting);
  const std::size_t equals = setting.find('=');
  if (equals == std::string_view::npos || equals == 0) {
    throw InputError(source + ": must be key=value, group.key=value");
  }
  YAML::Node node;
  try {
    node = LoadDocument(std::string(setting.substr(equals + 1)), source);
  } catch (const YAML::Exception& error) {
    throw InputError(source + ": " + error.msg);
  }
  std::string_view path = setting.substr(0, equals);
  while (!path.empty()) {
    const std::size_t dot = path.rfind('.');
    const std::string_view key =
        dot == std::string_view::npos ? path : path.substr(dot + 1);
    YAML::Node outer(YAML::NodeType::Map);
    outer.force_insert(std::string(key), node);
    node.reset(outer);
    path = dot == std::string_view::npos ? std::string_view{}
                                         : path.substr(0, dot);
  }
  LoadNode(node, source, false, describe);
}

}  // namespace waymark
