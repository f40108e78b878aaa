// Messages from what the simulated robot's sensors say.
#pragma once

#include "drivers/simulator/range_sensor.h"
#include "drivers/simulator/simulation.h"

#include <waymark/base_status_t.hpp>
#include <waymark/encoders_t.hpp>
#include <waymark/planar_lidar_t.hpp>
#include <waymark/truth_t.hpp>

#include <cstdint>
#include <vector>

namespace waymark {

[[nodiscard]] encoders_t ToMessage(const EncoderEvent& event, std::int64_t seq);
// `options`: of the sensor whose ranges they are.
[[nodiscard]] planar_lidar_t ToMessage(const RangeEvent& event,
                                       const RangeSensorOptions& options);
[[nodiscard]] base_status_t ToMessage(const BaseEvent& event, std::int64_t seq);
[[nodiscard]] truth_t ToMessage(const TruthEvent& event, std::int64_t seq);

// From the order of Simulation::AdvanceTo to that in which they are sent:
// encoders come last of those of one time, so that who answers them has seen
// the rest.
void SortForSending(std::vector<SimulationEvent>* events);

}  // namespace waymark
