// Configuration of a process: loading from strict YAML, printing, and the
// reference for users, all from one Describe() function (describer.h).
#pragma once

#include "estimation/base/input_error.h"
#include "processes/support/describer.h"

#include <functional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace waymark {

using DescribeFunction = std::function<void(Describer&)>;

// Sets the described fields that `yaml` gives; all others keep their value.
// `source` names the text in errors: a file's path.
//
// Throws InputError with "file:line: key = value: allowed range" where the
// text is no YAML mapping, a key is unknown or given twice, or a value has the
// wrong type, is not finite or out of range. Quoted numbers are text.
void LoadConfigurationText(std::string_view yaml,
                           std::string_view source,
                           const DescribeFunction& describe);

// The same from a file; InputError where it cannot be read.
void LoadConfigurationFile(const std::string& path,
                           const DescribeFunction& describe);

// Sets one field from "a.b=value", value in YAML; "a.b=" is the empty text.
void ApplySetting(std::string_view setting, const DescribeFunction& describe);

// All values as YAML that loads back to the same values, bit for bit (angles in
// radians to which no number of degrees converts: within a unit in the last
// place). Printing what was loaded back gives the same text.
[[nodiscard]] std::string PrintConfiguration(const DescribeFunction& describe);

// A markdown table of all keys: type, allowed range, current value (the
// default where nothing was loaded), meaning.
[[nodiscard]] std::string DescribeConfiguration(
    const DescribeFunction& describe);

// Defaults, then the file (none where `path` is empty), then the settings,
// then the configuration's own Check(). Throws InputError.
template <typename Config>
void LoadConfiguration(const std::string& path,
                       const std::vector<std::string>& settings,
                       Config* config) {
  const DescribeFunction describe = [config](Describer& d) {
    config->Describe(d);
  };
  if (!path.empty()) LoadConfigurationFile(path, describe);
  for (const std::string& setting : settings) ApplySetting(setting, describe);
  if constexpr (requires { config->Check(); }) {
    try {
      config->Check();
    } catch (const std::invalid_argument& error) {
      throw InputError((path.empty() ? "configuration" : path) +
                       (settings.empty() ? ": " : " with --set: ") +
                       error.what());
    }
  }
}

}  // namespace waymark
