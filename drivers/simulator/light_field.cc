#include "drivers/simulator/light_field.h"

#include "drivers/simulator/lamp_light.h"
#include "estimation/base/check.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>

namespace waymark {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

constexpr int kLanes = RayPacket::kLanes;

// Lamps that cannot add this much, about a third of the darkest step of the
// sRGB curve, are left out.
constexpr double kLeastLight = 1e-4;

// Shadow rays end this far before the lamp, which may lie on a ceiling.
constexpr double kLampGap = 0.005;

Float4 Colour(const Vector3d& light) {
  return Float4{static_cast<float>(light.x()),
                static_cast<float>(light.y()),
                static_cast<float>(light.z()),
                0.0f};
}

void SetLane(const Vector3f& direction, int lane, RayPacket* packet) {
  for (int axis = 0; axis < 3; ++axis) {
    packet->direction[axis][lane] = direction[axis];
  }
}

}  // namespace

void LightFieldOptions::Check() const {
  const auto refuse = [](const char* what) {
    throw std::invalid_argument(std::string("light field: ") + what);
  };
  if (lamp_samples < 1 || lamp_samples > 16) {
    refuse("lamp_samples must be 1 to 16");
  }
  if (num_rings < 1 || num_rings > 64) refuse("num_rings must be 1 to 64");
  if (!(ambient_radius > 0.0) || !std::isfinite(ambient_radius)) {
    refuse("ambient_radius must be positive");
  }
}

LightField::LightField(const Scene& scene, const LightFieldOptions& options)
    : options_(options),
      caster_(scene, RayCaster::Content::kOccluders),
      lamps_(scene.lamps),
      ambient_(Colour(scene.ambient)) {
  options.Check();
  // Rings of equal share of the cosine; each turned by another part of its
  // step, so that no plane of a room holds whole rows of rays. Each packet goes
  // through the rings, so that it sees something of everything.
  constexpr double kTurn = 0.37;
  for (int packet = 0; packet < options.num_rings; ++packet) {
    for (int i = 0; i < kLanes; ++i) {
      const int ring = (packet + i) % options.num_rings;
      const double radius = std::sqrt((ring + 0.5) / options.num_rings);
      const double angle =
          2.0 * std::numbers::pi * (i + 0.5 + kTurn * ring) / kLanes;
      directions_.push_back(Vector3d(radius * std::cos(angle),
                                     radius * std::sin(angle),
                                     std::sqrt(1.0 - radius * radius))
                                .cast<float>());
    }
  }
  // Every second sample of a lamp first, as on a chessboard.
  for (const int parity : {0, 1}) {
    for (int i = 0; i < options.lamp_samples; ++i) {
      for (int j = 0; j < options.lamp_samples; ++j) {
        if ((i + j) % 2 != parity) continue;
        lamp_places_.emplace_back((i + 0.5) / options.lamp_samples - 0.5,
                                  (j + 0.5) / options.lamp_samples - 0.5);
      }
    }
  }
}

double LightField::VisibleShare(const SceneLamp& lamp,
                                const Vector3d& p_W,
                                const Vector3d& n_W) const {
  const std::size_t num = lamp_places_.size();
  const std::size_t half = (num + 1) / 2;
  double seen = 0.0;
  double all = 0.0;
  RayPacket packet;
  packet.is_coherent = true;
  SetOrigin(p_W.cast<float>(), &packet);
  for (std::size_t first = 0; first < num; first += kLanes) {
    if (first >= half && (seen == 0.0 || seen == all)) break;
    std::array<double, kLanes> weights{};
    packet.active = 0;
    for (int lane = 0; lane < kLanes; ++lane) {
      const std::size_t sample = first + static_cast<std::size_t>(lane);
      const Eigen::Vector2d place =
          lamp_places_[std::min(sample, num - 1)].cwiseProduct(lamp.size);
      const Vector3d to_lamp =
          lamp.p_W + Vector3d(place.x(), place.y(), 0.0) - p_W;
      const double distance = to_lamp.norm();
      const Vector3d direction = to_lamp / distance;
      SetLane(direction.cast<float>(), lane, &packet);
      packet.farthest[lane] = static_cast<float>(
          std::max(0.0, distance - kLampGap / std::abs(direction.z())));
      const double weight = n_W.dot(direction) * direction.z();
      if (sample >= num || !(weight > 0.0)) continue;
      packet.active |= 1u << lane;
      weights[static_cast<std::size_t>(lane)] = weight / (distance * distance);
    }
    const std::uint32_t occluded = caster_.Occluded(packet);
    for (int lane = 0; lane < kLanes; ++lane) {
      const double weight = weights[static_cast<std::size_t>(lane)];
      all += weight;
      if ((occluded >> lane & 1u) == 0) seen += weight;
    }
  }
  return all > 0.0 ? seen / all : 0.0;
}

Float4 LightField::Direct(const Vector3d& p_W,
                          const Vector3d& n_W,
                          LampSet among,
                          LampSet* seen) const {
  Vector3d sum = Vector3d::Zero();
  for (std::size_t i = 0; i < lamps_.size(); ++i) {
    const SceneLamp& lamp = lamps_[i];
    const LampSet bit = LampSet{1} << (i % 64);
    if ((among & bit) == 0) continue;
    // What it gives at most, from its nearest point.
    const Vector3d offset = lamp.p_W - p_W;
    if (offset.z() <= 0.0) continue;
    const Eigen::Vector2d beside =
        (offset.head<2>().cwiseAbs() - 0.5 * lamp.size).cwiseMax(0.0);
    const double square = beside.squaredNorm() + offset.z() * offset.z();
    if (lamp.radiance.maxCoeff() * lamp.size.prod() < kLeastLight * square) {
      continue;
    }
    const Vector3d light = LampIrradiance(lamp, p_W, n_W) * lamp.radiance;
    if (light.maxCoeff() < kLeastLight) continue;
    const double share = VisibleShare(lamp, p_W, n_W);
    sum += share * light;
    if (share > 0.0 && seen != nullptr) *seen |= bit;
  }
  return Colour(sum);
}

LightField::Gathered LightField::Gather(const Vector3d& p_W,
                                        const Vector3d& n_W,
                                        bool is_dark,
                                        const Radiosity& radiosity) const {
  Vector3d right;
  Vector3d up;
  PlaneAxes(n_W, &right, &up);
  Eigen::Matrix3f R_WL;
  R_WL << right.cast<float>(), up.cast<float>(), n_W.cast<float>();
  const Vector3f origin = p_W.cast<float>();
  const auto radius = static_cast<float>(options_.ambient_radius);
  RayPacket packet;
  packet.is_coherent = false;
  SetOrigin(origin, &packet);
  Gathered sum{Float4{}, 0.0f};
  float num = 0.0f;
  for (std::size_t first = 0; first < directions_.size(); first += kLanes) {
    // What eight rays cannot miss.
    constexpr float kOpen = static_cast<float>(kLanes);
    constexpr float kNarrow = 0.25f * static_cast<float>(kLanes);
    if (first == kLanes &&
        (sum.openness == kOpen || (is_dark && sum.openness < kNarrow))) {
      break;
    }
    num += static_cast<float>(kLanes);
    for (int lane = 0; lane < kLanes; ++lane) {
      SetLane(R_WL * directions_[first + static_cast<std::size_t>(lane)],
              lane,
              &packet);
    }
    caster_.Trace(&packet);
    for (int lane = 0; lane < kLanes; ++lane) {
      if (packet.triangle[lane] == RayPacket::kNothing) {
        sum.openness += 1.0f;
        continue;
      }
      const Vector3f direction(packet.direction[0][lane],
                               packet.direction[1][lane],
                               packet.direction[2][lane]);
      sum.openness += std::min(1.0f, packet.distance[lane] / radius);
      sum.light += radiosity(packet.triangle[lane],
                             origin + packet.distance[lane] * direction,
                             direction);
    }
  }
  const float share = 1.0f / num;
  sum.openness *= share;
  sum.light = Broadcast(share) * sum.light + Broadcast(sum.openness) * ambient_;
  return sum;
}

bool LightField::AreApart(std::span<const Vector3d> points_W) const {
  WAYMARK_CHECK(points_W.size() <= 4, points_W.size());
  RayPacket packet;
  packet.is_coherent = false;
  packet.active = 0;
  SetOrigin(Vector3f::Zero(), &packet);
  std::fill_n(packet.farthest, kLanes, 1.0f);
  for (int lane = 0; lane < kLanes; ++lane) {
    SetLane(Vector3f::UnitZ(), lane, &packet);
  }
  int lane = 0;
  for (std::size_t i = 0; i < points_W.size(); ++i) {
    for (std::size_t j = i + 1; j < points_W.size(); ++j, ++lane) {
      const Vector3f origin = points_W[i].cast<float>();
      for (int axis = 0; axis < 3; ++axis) {
        packet.origin[axis][lane] = origin[axis];
      }
      SetLane((points_W[j] - points_W[i]).cast<float>(), lane, &packet);
      // Points at one place have nothing between them.
      if (points_W[j] != points_W[i]) packet.active |= 1u << lane;
    }
  }
  return caster_.Occluded(packet) != 0;
}

void PlaneAxes(const Vector3d& normal, Vector3d* right, Vector3d* up) {
  // Up to 2 degrees off the vertical: a floor.
  constexpr double kLevel = 0.9994;
  if (std::abs(normal.z()) > kLevel) {
    *right = (Vector3d::UnitX() - normal.x() * normal).normalized();
  } else {
    *right = Vector3d::UnitZ().cross(normal).normalized();
  }
  *up = normal.cross(*right);
}

}  // namespace waymark
