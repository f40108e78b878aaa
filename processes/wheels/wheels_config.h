// Configuration of wheels.
#pragma once

#include "drivers/wheels/create_base.h"
#include "processes/support/describer.h"

namespace waymark {

struct WheelsConfig {
  CreateBaseOptions create;
  double period_s = 0.02;

  void Describe(Describer& d);
  // Throws std::invalid_argument naming the key.
  void Check() const { create.Check(); }
};

}  // namespace waymark
