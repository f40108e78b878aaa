#include "estimation/camera/intrinsics_check.h"

#include <cmath>
#include <stdexcept>
#include <string>

namespace waymark {

void RequireFinite(double value, const char* name) {
  if (std::isfinite(value)) return;
  throw std::invalid_argument(std::string(name) + " is not finite");
}

void RequireUsable(const Intrinsics& intrinsics) {
  RequireFinite(intrinsics.fx, "fx");
  RequireFinite(intrinsics.fy, "fy");
  RequireFinite(intrinsics.cx, "cx");
  RequireFinite(intrinsics.cy, "cy");
  if (intrinsics.fx == 0.0) throw std::invalid_argument("fx is 0");
  if (intrinsics.fy == 0.0) throw std::invalid_argument("fy is 0");
}

void RequireUsable(const LensDistortion& distortion) {
  RequireFinite(distortion.k1, "k1");
  RequireFinite(distortion.k2, "k2");
  RequireFinite(distortion.p1, "p1");
  RequireFinite(distortion.p2, "p2");
  RequireFinite(distortion.k3, "k3");
}

}  // namespace waymark
