// Ranges of the simulator's options.
#pragma once

#include <string>

namespace waymark {

// Each throws std::invalid_argument, "field = value is not above 0", unless
// the value is finite and in range. `field` is the name in the struct.
void RequireAbove0(const std::string& field, double value);
void RequireNotNegative(const std::string& field, double value);
// Ends included.
void RequireWithin(const std::string& field,
                   double value,
                   double low,
                   double high);

}  // namespace waymark
