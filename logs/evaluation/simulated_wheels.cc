#include "logs/evaluation/simulated_wheels.h"

#include <yaml-cpp/yaml.h>

namespace waymark {

std::optional<WheelParameters> SimulatedWheels(const std::string& yaml) {
  // A log may hold anything.
  try {
    const YAML::Node config = YAML::Load(yaml);
    const YAML::Node robot = config["robot"];
    const YAML::Node noise = config["noise"];
    const auto per_tick = robot["meters_per_tick"].as<double>();
    return WheelParameters{per_tick * noise["right_wheel_factor"].as<double>(),
                           per_tick * noise["left_wheel_factor"].as<double>(),
                           robot["wheel_base"].as<double>() *
                               noise["wheel_base_factor"].as<double>()};
  } catch (const YAML::Exception&) {
    return std::nullopt;
  }
}

}  // namespace waymark
