#include "processes/support/yaml_group.h"

#include "estimation/base/input_error.h"
#include "estimation/base/whole_file.h"
#include "processes/support/configuration_range.h"

#include <spdlog/fmt/fmt.h>
#include <yaml-cpp/eventhandler.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <set>
#include <sstream>

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

// A scalar without quotes; quotes make it text.
bool IsPlain(const YAML::Node& node) {
  return node.IsScalar() && node.Tag() != "!";
}

// Documents are counted first, and not further than two: text such as ",a"
// makes yaml-cpp 0.7 report documents without end, and its LoadAll() takes
// memory for each.
void CheckOneDocument(const std::string& text, const std::string& source) {
  std::istringstream stream(text);
  YAML::Parser parser(stream);
  IgnoringHandler handler;
  for (int count = 0; parser.HandleNextDocument(handler); ++count) {
    if (count == 1) throw InputError(source + ": must be one YAML document");
  }
}

}  // namespace

std::string ReadYamlFile(const std::string& path) {
  // A hundred times the longest that anyone has written.
  constexpr std::size_t kMaxBytes = std::size_t{16} << 20U;
  return ReadWholeFile(path, kMaxBytes);
}

YAML::Node LoadYamlDocument(const std::string& text,
                            const std::string& source,
                            bool has_lines) {
  try {
    CheckOneDocument(text, source);
    return YAML::Load(text);
  } catch (const YAML::Exception& error) {
    throw InputError(
        has_lines
            ? fmt::format("{}:{}: {}", source, error.mark.line + 1, error.msg)
            : fmt::format("{}: {}", source, error.msg));
  }
}

YamlGroup::YamlGroup(const YAML::Node& root, std::string source, bool has_lines)
    : YamlGroup(root.IsNull() ? YAML::Node(YAML::NodeType::Map) : root,
                std::make_shared<const std::string>(std::move(source)),
                has_lines,
                "",
                0) {}

YamlGroup::YamlGroup(const YAML::Node& node,
                     std::shared_ptr<const std::string> source,
                     bool has_lines,
                     std::string path,
                     int line)
    : node_(node),
      source_(std::move(source)),
      has_lines_(has_lines),
      path_(std::move(path)),
      line_(line) {
  if (!node_.IsMap()) {
    throw InputError(*source_ + ": must be a list of 'key: value' lines");
  }
  CheckKeys();
}

// For keys given twice: yaml-cpp keeps both and finds the first.
void YamlGroup::CheckKeys() const {
  std::set<std::string> seen;
  for (const auto& entry : node_) {
    if (!entry.first.IsScalar()) {
      throw InputError(Place(entry.first) + "a key must be a plain word");
    }
    if (!seen.insert(entry.first.Scalar()).second) {
      throw InputError(fmt::format("{}{}: given twice",
                                   Place(entry.first),
                                   FullKey(entry.first.Scalar())));
    }
  }
}

std::optional<double> YamlGroup::Number(std::string_view key, Range range) {
  const std::optional<YAML::Node> node = Take(key);
  if (!node) return std::nullopt;
  return ToNumber(*node, std::string(key), range);
}

std::optional<std::int64_t> YamlGroup::Integer(std::string_view key,
                                               std::int64_t min,
                                               std::int64_t max) {
  const std::optional<YAML::Node> node = Take(key);
  if (!node) return std::nullopt;
  const auto parsed =
      IsPlain(*node) ? ParseWhole<std::int64_t>(node->Scalar()) : std::nullopt;
  if (!parsed || *parsed < min || *parsed > max) {
    RefuseNode(*node, key, "must be a whole number" + IntegerRange(min, max));
  }
  return parsed;
}

std::optional<bool> YamlGroup::Flag(std::string_view key) {
  const std::optional<YAML::Node> node = Take(key);
  if (!node) return std::nullopt;
  const bool is_true = IsPlain(*node) && node->Scalar() == "true";
  if (!is_true && !(IsPlain(*node) && node->Scalar() == "false")) {
    RefuseNode(*node, key, "must be true or false");
  }
  return is_true;
}

std::optional<std::string> YamlGroup::Text(std::string_view key) {
  const std::optional<YAML::Node> node = Take(key);
  if (!node) return std::nullopt;
  if (!node->IsScalar()) RefuseNode(*node, key, "must be text");
  return node->Scalar();
}

std::optional<int> YamlGroup::Choice(std::string_view key,
                                     const std::vector<std::string>& names) {
  const std::optional<YAML::Node> node = Take(key);
  if (!node) return std::nullopt;
  const auto found = node->IsScalar()
                         ? std::find(names.begin(), names.end(), node->Scalar())
                         : names.end();
  if (found == names.end()) {
    RefuseNode(
        *node, key, fmt::format("must be one of: {}", fmt::join(names, ", ")));
  }
  return static_cast<int>(found - names.begin());
}

std::optional<std::vector<double>> YamlGroup::Numbers(std::string_view key,
                                                      int size,
                                                      Range range) {
  const std::optional<YAML::Node> node = Take(key);
  if (!node) return std::nullopt;
  if (!node->IsSequence() ||
      (size >= 0 && node->size() != static_cast<std::size_t>(size))) {
    RefuseNode(*node,
               key,
               size < 0 ? std::string("must be a list of numbers")
                        : fmt::format("must be a list of {} numbers", size));
  }
  std::vector<double> numbers;
  for (std::size_t i = 0; i < node->size(); ++i) {
    numbers.push_back(
        ToNumber((*node)[i], fmt::format("{}[{}]", key, i), range));
  }
  return numbers;
}

std::optional<std::vector<std::vector<double>>> YamlGroup::Rows(
    std::string_view key, std::size_t min_rows, int size, Range range) {
  const std::optional<YAML::Node> node = Take(key);
  if (!node) return std::nullopt;
  if (!node->IsSequence() || node->size() < min_rows) {
    RefuseNode(*node,
               key,
               fmt::format("must be a list of {} or more lists of {} numbers",
                           min_rows,
                           size));
  }
  std::vector<std::vector<double>> rows;
  for (std::size_t i = 0; i < node->size(); ++i) {
    const YAML::Node row = (*node)[i];
    const std::string name = fmt::format("{}[{}]", key, i);
    if (!row.IsSequence() || row.size() != static_cast<std::size_t>(size)) {
      RefuseNode(row, name, fmt::format("must be a list of {} numbers", size));
    }
    rows.emplace_back();
    for (std::size_t k = 0; k < row.size(); ++k) {
      rows.back().push_back(ToNumber(row[k], name, range));
    }
  }
  return rows;
}

YamlGroup YamlGroup::Inner(const YAML::Node& node,
                           const std::string& key) const {
  if (!node.IsMap() && !node.IsNull()) {
    RefuseNode(node, key, "must be a group of keys");
  }
  return {node.IsMap() ? node : YAML::Node(YAML::NodeType::Map),
          source_,
          has_lines_,
          FullKey(key) + '.',
          node.IsNull() ? key_line_ : node.Mark().line};
}

std::optional<YamlGroup> YamlGroup::Group(std::string_view key) {
  const std::optional<YAML::Node> node = Take(key);
  if (!node) return std::nullopt;
  return Inner(*node, std::string(key));
}

std::vector<YamlGroup> YamlGroup::Groups(std::string_view key) {
  const std::optional<YAML::Node> node = Take(key);
  std::vector<YamlGroup> groups;
  if (!node) return groups;
  if (!node->IsSequence()) RefuseNode(*node, key, "must be a list of groups");
  for (std::size_t i = 0; i < node->size(); ++i) {
    groups.push_back(Inner((*node)[i], fmt::format("{}[{}]", key, i)));
  }
  return groups;
}

std::vector<std::string> YamlGroup::keys() const {
  std::vector<std::string> names;
  for (const auto& entry : node_) names.push_back(entry.first.Scalar());
  return names;
}

bool YamlGroup::Has(std::string_view key) const {
  return std::any_of(node_.begin(), node_.end(), [&](const auto& entry) {
    return entry.first.Scalar() == key;
  });
}

bool YamlGroup::IsEmptyList(std::string_view key) const {
  return std::any_of(node_.begin(), node_.end(), [&](const auto& entry) {
    return entry.first.Scalar() == key && entry.second.IsSequence() &&
           entry.second.size() == 0;
  });
}

void YamlGroup::Finish() const {
  for (const auto& entry : node_) {
    const std::string& key = entry.first.Scalar();
    if (std::find(known_.begin(), known_.end(), key) != known_.end()) continue;
    throw InputError(fmt::format("{}{}: unknown key; known here: {}",
                                 Place(entry.first),
                                 FullKey(key),
                                 fmt::join(known_, ", ")));
  }
}

std::optional<YAML::Node> YamlGroup::Take(std::string_view key) {
  if (std::find(known_.begin(), known_.end(), key) == known_.end()) {
    known_.emplace_back(key);
  }
  for (const auto& entry : node_) {
    if (entry.first.Scalar() != key) continue;
    key_line_ = entry.first.Mark().line;
    return entry.second;
  }
  return std::nullopt;
}

double YamlGroup::ToNumber(const YAML::Node& node,
                           const std::string& key,
                           Range range) const {
  const auto parsed =
      IsPlain(node) ? ParseWhole<double>(node.Scalar()) : std::nullopt;
  if (!parsed || !std::isfinite(*parsed) || *parsed < range.min ||
      *parsed > range.max) {
    RefuseNode(node, key, "must be a number" + NumberRange(range));
  }
  return *parsed;
}

void YamlGroup::Refuse(std::string_view key, const std::string& allowed) const {
  for (const auto& entry : node_) {
    if (entry.first.Scalar() == key) RefuseNode(entry.second, key, allowed);
  }
  throw InputError(
      fmt::format("{}{}: {}", Place(line_), FullKey(key), allowed));
}

void YamlGroup::Miss(std::string_view key) const {
  throw InputError(fmt::format("{}{}: is missing", Place(line_), FullKey(key)));
}

std::string YamlGroup::Where(const std::string& name) const {
  std::string where = Place(line_) + path_;
  if (!path_.empty()) where.pop_back();  // The dot.
  return name.empty() ? where : where + " (" + name + ")";
}

void YamlGroup::RefuseNode(const YAML::Node& node,
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
  throw InputError(
      fmt::format("{}{} = {}: {}", Place(node), FullKey(key), value, allowed));
}

std::string YamlGroup::FullKey(std::string_view key) const {
  return path_ + std::string(key);
}

std::string YamlGroup::Place(const YAML::Node& node) const {
  // An absent value has no place of its own.
  return Place(node.IsNull() ? key_line_ : node.Mark().line);
}

std::string YamlGroup::Place(int line) const {
  if (!has_lines_) return *source_ + ": ";
  return fmt::format("{}:{}: ", *source_, line + 1);  // Marks count from 0.
}

}  // namespace waymark
