#include "processes/support/configuration.h"
#include "processes/support/configuration_range.h"

#include <spdlog/fmt/fmt.h>
#include <yaml-cpp/yaml.h>

#include <charconv>
#include <cmath>
#include <iterator>
#include <limits>
#include <stdexcept>

namespace waymark {
namespace {

// Shortest digits that read back as the same double.
std::string Digits(double value) {
  if (!std::isfinite(value)) {
    throw std::logic_error("a configuration value is not finite");
  }
  char buffer[32];
  const auto end = std::to_chars(buffer, std::end(buffer), value).ptr;
  return {buffer, end};
}

// Degrees that load back as the same radians, with the fewest digits. Not
// every double is a multiple of pi / 180: beside such one, the nearest that is.
double DegreesFor(double radians) {
  const double degrees = radians / kRadiansPerDegree;
  for (int num_digits = 15; num_digits <= 17; ++num_digits) {
    const double rounded =
        std::stod(fmt::format("{:.{}g}", degrees, num_digits));
    if (rounded * kRadiansPerDegree == radians) return rounded;
  }
  double below = degrees;
  double above = degrees;
  // The quotient and the product round by half a unit in the last place each.
  for (int i = 0; i < 4; ++i) {
    if (below * kRadiansPerDegree == radians) return below;
    if (above * kRadiansPerDegree == radians) return above;
    below = std::nextafter(below, -HUGE_VAL);
    above = std::nextafter(above, HUGE_VAL);
  }
  return DegreesFor(degrees * kRadiansPerDegree);
}

std::string Quoted(const std::string& text) {
  YAML::Emitter out;
  out << YAML::DoubleQuoted << text;
  return out.c_str();
}

std::string ListOf(const std::vector<double>& values) {
  std::vector<std::string> digits;
  for (const double value : values) digits.push_back(Digits(value));
  return fmt::format("[{}]", fmt::join(digits, ", "));
}

// Collects every field with its value as YAML and its allowed range.
class Collector : public Describer {
 public:
  void Number(std::string_view key,
              double* value,
              Range range,
              std::string_view help) override {
    Add(key, Digits(*value), "number" + NumberRange(range), help);
  }
  void Degrees(std::string_view key,
               double* value_rad,
               Range range_deg,
               std::string_view help) override {
    Add(key, Angle(*value_rad), "number" + NumberRange(range_deg), help);
  }
  void Integer(std::string_view key,
               std::int64_t* value,
               std::int64_t min,
               std::int64_t max,
               std::string_view help) override {
    Add(key,
        std::to_string(*value),
        "whole number" + IntegerRange(min, max),
        help);
  }
  void Flag(std::string_view key, bool* value, std::string_view help) override {
    Add(key, *value ? "true" : "false", "true, false", help);
  }
  void Text(std::string_view key,
            std::string* value,
            std::string_view help) override {
    Add(key, Quoted(*value), "text", help);
  }
  void Numbers(std::string_view key,
               std::vector<double>* values,
               int size,
               std::string_view help) override {
    Add(key,
        ListOf(*values),
        size < 0 ? "list of numbers" : fmt::format("list of {} numbers", size),
        help);
  }
  void ChoiceIndex(std::string_view key,
                   int* index,
                   const std::vector<std::string>& names,
                   std::string_view help) override {
    Add(key,
        names.at(static_cast<std::size_t>(*index)),
        fmt::format("{}", fmt::join(names, ", ")),
        help);
  }

 protected:
  [[nodiscard]] virtual std::string Angle(double radians) const {
    return Digits(DegreesFor(radians));
  }
  virtual void Add(std::string_view key,
                   const std::string& value,
                   const std::string& allowed,
                   std::string_view help) = 0;
};

class Printer final : public Collector {
 public:
  void Group(std::string_view key,
             const std::function<void()>& describe,
             std::string_view /*help*/) override {
    text += fmt::format("{}{}:\n", indent_, key);
    indent_ += "  ";
    describe();
    indent_.resize(indent_.size() - 2);
  }
  std::string text;

 protected:
  void Add(std::string_view key,
           const std::string& value,
           const std::string& /*allowed*/,
           std::string_view /*help*/) override {
    text += fmt::format("{}{}: {}\n", indent_, key, value);
  }

 private:
  std::string indent_;
};

class ReferenceWriter final : public Collector {
 public:
  void Group(std::string_view key,
             const std::function<void()>& describe,
             std::string_view help) override {
    if (!help.empty())
      Row(fmt::format("**`{}{}`**", prefix_, key), "", "", help);
    const std::string outer = prefix_;
    prefix_ += std::string(key) + '.';
    describe();
    prefix_ = outer;
  }
  std::string text =
      "| key | default | allowed | meaning |\n"
      "|---|---|---|---|\n";

 protected:
  // A default in radians has no short number of degrees: for reading, rounded.
  [[nodiscard]] std::string Angle(double radians) const override {
    return fmt::format("{:.6g}", radians / kRadiansPerDegree);
  }
  void Add(std::string_view key,
           const std::string& value,
           const std::string& allowed,
           std::string_view help) override {
    Row(fmt::format("`{}{}`", prefix_, key),
        fmt::format("`{}`", value),
        allowed,
        help);
  }

 private:
  void Row(const std::string& key,
           const std::string& value,
           const std::string& allowed,
           std::string_view help) {
    text += '|';
    for (const std::string_view cell : {std::string_view(key),
                                        std::string_view(value),
                                        std::string_view(allowed),
                                        help}) {
      text += ' ';
      for (const char c : cell) text += c == '|' ? "\\|" : std::string(1, c);
      text += " |";
    }
    text += '\n';
  }
  std::string prefix_;
};

}  // namespace

std::string NumberRange(Range range) {
  const bool has_min = std::isfinite(range.min);
  const bool has_max = std::isfinite(range.max);
  // kPositive's end is the smallest positive number.
  if (range.min == kPositive.min) {
    return has_max ? fmt::format(" in (0, {}]", range.max) : " > 0";
  }
  if (has_min && has_max) {
    return fmt::format(" in [{}, {}]", range.min, range.max);
  }
  if (has_min) return fmt::format(" >= {}", range.min);
  if (has_max) return fmt::format(" <= {}", range.max);
  return "";
}
std::string IntegerRange(std::int64_t min, std::int64_t max) {
  const bool has_min = min != std::numeric_limits<std::int64_t>::min();
  const bool has_max = max != std::numeric_limits<std::int64_t>::max();
  if (has_min && has_max) return fmt::format(" in [{}, {}]", min, max);
  if (has_min) return fmt::format(" >= {}", min);
  if (has_max) return fmt::format(" <= {}", max);
  return "";
}

std::string PrintConfiguration(const DescribeFunction& describe) {
  Printer printer;
  describe(printer);
  return printer.text;
}

std::string DescribeConfiguration(const DescribeFunction& describe) {
  ReferenceWriter writer;
  describe(writer);
  return writer.text;
}

}  // namespace waymark
