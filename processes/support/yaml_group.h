// Strict reading of YAML: every key known, given once, of the right type and
// range, or one line that says where it is not.
#pragma once

#include "processes/support/describer.h"

#include <yaml-cpp/yaml.h>

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace waymark {

// Text of a file of at most 16 MiB; throws as ReadWholeFile() does.
[[nodiscard]] std::string ReadYamlFile(const std::string& path);

// The one YAML document in `text`. `source` names it in errors, with lines of
// it where it has any.
[[nodiscard]] YAML::Node LoadYamlDocument(const std::string& text,
                                          const std::string& source,
                                          bool has_lines = true);

// One mapping of a document. What it refuses, it refuses by InputError with
// "file:line: key = value: allowed range", the key with those of the groups
// that it is in. Quoted numbers are text. Absent keys give nullopt, or what
// was passed as `otherwise`.
class YamlGroup {
 public:
  // The outermost mapping; an empty document is one without keys.
  YamlGroup(const YAML::Node& root, std::string source, bool has_lines = true);

  [[nodiscard]] std::optional<double> Number(std::string_view key, Range range);
  [[nodiscard]] std::optional<std::int64_t> Integer(std::string_view key,
                                                    std::int64_t min,
                                                    std::int64_t max);
  [[nodiscard]] std::optional<bool> Flag(std::string_view key);
  [[nodiscard]] std::optional<std::string> Text(std::string_view key);
  // Index of one of `names`.
  [[nodiscard]] std::optional<int> Choice(
      std::string_view key, const std::vector<std::string>& names);
  // A list of exactly `size` numbers; size < 0: any length.
  [[nodiscard]] std::optional<std::vector<double>> Numbers(std::string_view key,
                                                           int size,
                                                           Range range = {});
  // A list of at least `min_rows` lists of `size` numbers each.
  [[nodiscard]] std::optional<std::vector<std::vector<double>>> Rows(
      std::string_view key, std::size_t min_rows, int size, Range range);
  [[nodiscard]] std::optional<YamlGroup> Group(std::string_view key);
  // A list of mappings; empty where absent.
  [[nodiscard]] std::vector<YamlGroup> Groups(std::string_view key);
  // A mapping of names to anything: the names in order. Their values are read
  // as keys of Group(key).
  [[nodiscard]] std::vector<std::string> keys() const;

  [[nodiscard]] bool Has(std::string_view key) const;
  [[nodiscard]] bool IsEmptyList(std::string_view key) const;
  // Refuses keys that nothing has asked for.
  void Finish() const;

  // Refuses the value of a key, or the group for want of the key.
  [[noreturn]] void Refuse(std::string_view key,
                           const std::string& allowed) const;
  [[noreturn]] void Miss(std::string_view key) const;
  // "file:line: rooms[2]", with `name` "file:line: rooms[2] (name)".
  [[nodiscard]] std::string Where(const std::string& name = "") const;

 private:
  YamlGroup(const YAML::Node& node,
            std::shared_ptr<const std::string> source,
            bool has_lines,
            std::string path,
            int line);

  [[nodiscard]] std::optional<YAML::Node> Take(std::string_view key);
  [[nodiscard]] double ToNumber(const YAML::Node& node,
                                const std::string& key,
                                Range range) const;
  [[nodiscard]] YamlGroup Inner(const YAML::Node& node,
                                const std::string& key) const;
  [[noreturn]] void RefuseNode(const YAML::Node& node,
                               std::string_view key,
                               const std::string& allowed) const;
  [[nodiscard]] std::string FullKey(std::string_view key) const;
  [[nodiscard]] std::string Place(const YAML::Node& node) const;
  [[nodiscard]] std::string Place(int line) const;
  void CheckKeys() const;

  YAML::Node node_;
  std::shared_ptr<const std::string> source_;
  bool has_lines_;
  std::string path_;  // Of the groups around it, with a dot behind each.
  int line_;          // Where the group stands, from 0.
  int key_line_ = 0;  // Of the key taken last.
  std::vector<std::string> known_;
};

}  // namespace waymark
