#include "estimation/lines/line_direction.h"

#include "estimation/base/check.h"

#include <cmath>
#include <stdexcept>

namespace waymark {

void PinholeView::Check() const {
  if (!(fx > 0.0) || !std::isfinite(fx)) {
    throw std::invalid_argument("fx must be positive");
  }
  if (!(fy > 0.0) || !std::isfinite(fy)) {
    throw std::invalid_argument("fy must be positive");
  }
  if (!std::isfinite(cx)) throw std::invalid_argument("cx must be finite");
  if (!std::isfinite(cy)) throw std::invalid_argument("cy must be finite");
}

double LineDirection::Sigma(const Eigen::Vector3d& n_C) const {
  return std::hypot(sigma_px * n_C.z(), sigma_rad * along_C.dot(n_C));
}

double LineDirection::Residual(const Eigen::Vector3d& n_C) const {
  return across_C.dot(n_C) / Sigma(n_C);
}

std::vector<LineDirection> LineDirections(std::span<const LineSegment> lines,
                                          const PinholeView& view) {
  view.Check();
  std::vector<LineDirection> directions;
  directions.reserve(lines.size());
  // t' K n_C - t' middle n_z, for the unit vector t.
  const auto form = [&](const Eigen::Vector2d& t,
                        const Eigen::Vector2d& middle) {
    return Eigen::Vector3d(
        t.x() * view.fx,
        t.y() * view.fy,
        t.x() * (view.cx - middle.x()) + t.y() * (view.cy - middle.y()));
  };
  for (const LineSegment& line : lines) {
    WAYMARK_CHECK(line.a.allFinite() && line.b.allFinite());
    WAYMARK_CHECK(line.a != line.b);
    WAYMARK_CHECK(line.sigma_px > 0.0, line.sigma_px);
    WAYMARK_CHECK(line.sigma_rad > 0.0, line.sigma_rad);
    const Eigen::Vector2d t = (line.b - line.a).normalized();
    const Eigen::Vector2d middle = 0.5 * (line.a + line.b);
    directions.push_back({form({-t.y(), t.x()}, middle),
                          form(t, middle),
                          line.sigma_px,
                          line.sigma_rad});
  }
  return directions;
}

}  // namespace waymark
