#include "processes/support/configuration.h"

#include "processes/support/configuration_range.h"
#include "processes/support/yaml_group.h"

#include <spdlog/fmt/fmt.h>

#include <optional>
#include <utility>

namespace waymark {
namespace {

// Sets fields from one YAML document.
class Loader final : public Describer {
 public:
  explicit Loader(YamlGroup root) { levels_.push_back(std::move(root)); }

  void Finish() const { levels_.back().Finish(); }

  void Number(std::string_view key,
              double* value,
              Range range,
              std::string_view /*help*/) override {
    if (const auto given = Here().Number(key, range)) *value = *given;
  }
  void Degrees(std::string_view key,
               double* value_rad,
               Range range_deg,
               std::string_view /*help*/) override {
    if (const auto given = Here().Number(key, range_deg)) {
      *value_rad = *given * kRadiansPerDegree;
    }
  }
  void Integer(std::string_view key,
               std::int64_t* value,
               std::int64_t min,
               std::int64_t max,
               std::string_view /*help*/) override {
    if (const auto given = Here().Integer(key, min, max)) *value = *given;
  }
  void Flag(std::string_view key,
            bool* value,
            std::string_view /*help*/) override {
    if (const auto given = Here().Flag(key)) *value = *given;
  }
  void Text(std::string_view key,
            std::string* value,
            std::string_view /*help*/) override {
    if (auto given = Here().Text(key)) *value = std::move(*given);
  }
  void Numbers(std::string_view key,
               std::vector<double>* values,
               int size,
               std::string_view /*help*/) override {
    // An empty list stands for 'not given' only where that is the default.
    const bool may_be_empty = values->empty() && Here().IsEmptyList(key);
    auto given = Here().Numbers(key, may_be_empty ? -1 : size);
    if (given) *values = std::move(*given);
  }
  void ChoiceIndex(std::string_view key,
                   int* index,
                   const std::vector<std::string>& names,
                   std::string_view /*help*/) override {
    if (const auto given = Here().Choice(key, names)) *index = *given;
  }
  void Group(std::string_view key,
             const std::function<void()>& describe,
             std::string_view /*help*/) override {
    // Without a group in the file the fields are visited all the same, to stay
    // in step.
    auto inner = Here().Group(key);
    levels_.push_back(inner ? std::move(*inner) : YamlGroup(YAML::Node(), ""));
    describe();
    levels_.back().Finish();
    levels_.pop_back();
  }

 private:
  YamlGroup& Here() { return levels_.back(); }

  std::vector<YamlGroup> levels_;
};

void LoadGroup(YamlGroup root, const DescribeFunction& describe) {
  Loader loader(std::move(root));
  describe(loader);
  loader.Finish();
}

}  // namespace

void LoadConfigurationText(std::string_view yaml,
                           std::string_view source,
                           const DescribeFunction& describe) {
  const std::string name(source);
  const YAML::Node document = LoadYamlDocument(std::string(yaml), name);
  if (!document.IsNull()) LoadGroup(YamlGroup(document, name), describe);
}

void LoadConfigurationFile(const std::string& path,
                           const DescribeFunction& describe) {
  LoadConfigurationText(ReadYamlFile(path), path, describe);
}

void ApplySetting(std::string_view setting, const DescribeFunction& describe) {
  const std::string source = fmt::format("--set {}", setting);
  const std::size_t equals = setting.find('=');
  if (equals == std::string_view::npos || equals == 0) {
    throw InputError(source + ": must be key=value, group.key=value");
  }
  // Nothing behind the sign is the empty text, which means 'none' to many keys.
  const std::string value(setting.substr(equals + 1));
  YAML::Node node =
      LoadYamlDocument(value.empty() ? "''" : value, source, false);
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
  LoadGroup(YamlGroup(node, source, false), describe);
}

}  // namespace waymark
