#include "processes/convert/world_values.h"

#include "estimation/base/input_error.h"

#include <algorithm>
#include <limits>

namespace waymark {
namespace {

constexpr std::int64_t kMaxSeed = std::numeric_limits<std::int64_t>::max();

// Letters beyond ASCII have bytes above it.
bool IsControl(char c) {
  return static_cast<unsigned char>(c) < ' ' || c == '\x7f';
}

}  // namespace

Eigen::Vector2d Vector2Of(const std::vector<double>& numbers) {
  return {numbers[0], numbers[1]};
}

double Required(YamlGroup* group, const std::string& key, Range range) {
  const auto value = group->Number(key, range);
  if (!value) group->Miss(key);
  return *value;
}

Eigen::Vector2d RequiredPoint(YamlGroup* group, const std::string& key) {
  const auto numbers = group->Numbers(key, 2, kCoordinate);
  if (!numbers) group->Miss(key);
  return Vector2Of(*numbers);
}

double Degrees(YamlGroup* group, const std::string& key, Range range) {
  return group->Number(key, range).value_or(0.0) * kRadiansPerDegree;
}

std::uint64_t Seed(YamlGroup* group, std::uint64_t otherwise) {
  return static_cast<std::uint64_t>(
      group->Integer("seed", 0, kMaxSeed)
          .value_or(static_cast<std::int64_t>(otherwise)));
}

std::vector<Eigen::Vector2d> Points(
    const std::vector<std::vector<double>>& rows) {
  std::vector<Eigen::Vector2d> points;
  for (const auto& row : rows) points.push_back(Vector2Of(row));
  return points;
}

void CheckIsOneLine(const YamlGroup& group,
                    const std::string& key,
                    const std::string& name) {
  if (std::none_of(name.begin(), name.end(), IsControl)) return;
  throw InputError(group.Where() + "." + key + " = " + Quoted(name) +
                   ": must be one line");
}

std::string Quoted(const std::string& name) {
  std::string text = "'";
  for (const char c : name) {
    if (!IsControl(c)) {
      text += c;
      continue;
    }
    constexpr const char* kDigits = "0123456789abcdef";
    const auto code = static_cast<unsigned char>(c);
    text.append("\\x") += kDigits[code / 16];
    text += kDigits[code % 16];
  }
  return text + "'";
}

std::string Joined(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) {
    text += (text.empty() ? "" : ", ") + name;
  }
  return text;
}

}  // namespace waymark
