#include "drivers/simulator/person_mesh.h"

#include "drivers/simulator/person_clothes.h"
#include "estimation/base/check.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <span>
#include <stdexcept>
#include <utility>
#include <vector>

namespace waymark {
namespace {

using Eigen::Vector3f;

// Lengths are those of a person of 1.75 m; Fit() stretches the whole.

// An ellipse in space: middle and half axes, from the front (+x) to the left.
struct Ring {
  Vector3f middle;
  Vector3f front;
  Vector3f left;
};

Ring Level(float x, float y, float z, float depth, float width) {
  return {{x, y, z}, {depth, 0.0f, 0.0f}, {0.0f, width, 0.0f}};
}

class Builder {
 public:
  Builder(std::uint32_t material, std::uint32_t surface, SceneMesh* mesh)
      : material_(material), surface_(surface), mesh_(mesh) {}

  // Skin over the rings, from the first to the last; u runs around from the
  // back over the right side, v along.
  void Loft(std::span<const Ring> rings, int segments) {
    const auto first = static_cast<std::uint32_t>(mesh_->positions.size());
    const auto across = static_cast<std::uint32_t>(segments) + 1;
    for (std::size_t i = 0; i < rings.size(); ++i) {
      for (std::uint32_t k = 0; k < across; ++k) {
        const float u = static_cast<float>(k) / static_cast<float>(segments);
        const float angle = 2.0f * std::numbers::pi_v<float> * u;
        mesh_->positions.push_back(rings[i].middle -
                                   std::cos(angle) * rings[i].front -
                                   std::sin(angle) * rings[i].left);
        mesh_->uvs.emplace_back(
            u, static_cast<float>(i) / static_cast<float>(rings.size() - 1));
      }
    }
    for (std::uint32_t i = 0; i + 1 < rings.size(); ++i) {
      for (std::uint32_t k = 0; k + 1 < across; ++k) {
        const std::uint32_t a = first + i * across + k;
        const std::uint32_t b = a + across;
        Add({a, a + 1, b});
        Add({a + 1, b + 1, b});
      }
    }
  }

  // Upright ellipsoid, v from the top.
  void Ball(const Vector3f& middle,
            const Vector3f& radii,
            int segments,
            int rows) {
    std::vector<Ring> rings;
    for (int i = 0; i <= rows; ++i) {
      const float angle = std::numbers::pi_v<float> * static_cast<float>(i) /
                          static_cast<float>(rows);
      rings.push_back(Level(middle.x(),
                            middle.y(),
                            middle.z() + radii.z() * std::cos(angle),
                            radii.x() * std::sin(angle),
                            radii.y() * std::sin(angle)));
    }
    Loft(rings, segments);
  }

  // Round limb along the joints, which have these radii, with closed ends.
  void Limb(std::span<const Vector3f> joints,
            std::span<const float> radii,
            int segments) {
    WAYMARK_CHECK(joints.size() == radii.size() && joints.size() >= 2);
    std::vector<Ring> rings;
    for (std::size_t i = 0; i < joints.size(); ++i) {
      const Vector3f along = (joints[std::min(i + 1, joints.size() - 1)] -
                              joints[i > 0 ? i - 1 : 0])
                                 .normalized();
      // Limbs hang: `along` is never along x.
      const Vector3f front =
          (Vector3f::UnitX() - along.x() * along).normalized();
      rings.push_back(
          {joints[i], radii[i] * front, radii[i] * front.cross(along)});
      if (i == 0 || i + 1 == joints.size()) {
        const float outward = i == 0 ? -1.0f : 1.0f;
        const Ring tip{joints[i] + 0.5f * outward * radii[i] * along,
                       1e-3f * front,
                       1e-3f * front.cross(along)};
        rings.insert(i == 0 ? rings.begin() : rings.end(), tip);
      }
    }
    Loft(rings, segments);
  }

 private:
  // At the poles of a ball every other triangle is only a line.
  void Add(const std::array<std::uint32_t, 3>& corners) {
    const Vector3f& a = mesh_->positions[corners[0]];
    const Vector3f& b = mesh_->positions[corners[1]];
    const Vector3f& c = mesh_->positions[corners[2]];
    constexpr float kLine = 1e-8f;  // m^2; a real one has 1e-6 or more.
    if ((b - a).cross(c - a).norm() < kLine) return;
    mesh_->triangles.push_back({corners, material_, surface_});
  }

  std::uint32_t material_;
  std::uint32_t surface_;
  SceneMesh* mesh_;
};

// Where the limbs are, by side: 0 left, 1 right; a step has the left leg and
// the right arm in front.
struct Stance {
  std::array<float, 2> knee_x{0.0f, 0.0f};
  std::array<float, 2> ankle_x{0.0f, 0.0f};
  std::array<float, 2> ankle_z{0.08f, 0.08f};
  std::array<float, 2> toe_drop{0.0f, 0.0f};  // Of the toes below the ankle.
  std::array<float, 2> elbow_x{-0.025f, -0.025f};
  std::array<float, 2> hand_x{0.03f, 0.03f};
};

Stance StanceOf(PersonPose pose) {
  Stance stance;
  if (pose == PersonPose::kMidStep) {
    stance.knee_x = {0.10f, 0.05f};
    stance.ankle_x = {0.06f, -0.17f};
    stance.ankle_z = {0.08f, 0.17f};
    stance.toe_drop = {0.0f, 0.09f};
    stance.elbow_x = {-0.12f, 0.03f};
    stance.hand_x = {-0.10f, 0.17f};
  }
  return stance;
}

class Person {
 public:
  Person(const PersonOptions& options, std::uint32_t surface, Scene* scene)
      : look_(MakePersonLook(options.seed)),
        stance_(StanceOf(options.pose)),
        surface_(surface),
        scene_(scene) {}

  SceneMesh Build(const std::string& name) {
    const auto add = [&](const char* part, const cv::Mat3b& texture) {
      scene_->materials.push_back({name + " " + part, texture, false});
      return Builder(static_cast<std::uint32_t>(scene_->materials.size() - 1),
                     surface_,
                     &mesh_);
    };
    Builder skin = add("skin", look_.skin);
    Builder trousers = add("trousers", look_.trousers);
    Builder shoe = add("shoe", look_.shoe);
    Builder sleeve = add("sleeve", look_.sleeve);
    for (const int side : {0, 1}) {
      AddLeg(side, &trousers, &shoe);
      AddArm(side, &sleeve, &skin);
    }
    Builder torso = add("torso", look_.torso);
    AddTorso(&torso, &trousers);
    Builder face = add("face", look_.face);
    Builder hair = add("hair", look_.hair);
    AddHead(&skin, &face, &hair);
    return std::move(mesh_);
  }

 private:
  static float SignOf(int side) { return side == 0 ? 1.0f : -1.0f; }

  void AddLeg(int side, Builder* trousers, Builder* shoe) {
    const auto i = static_cast<std::size_t>(side);
    const float y = 0.092f * SignOf(side);
    const Vector3f hip(0.0f, y, 0.88f);
    const Vector3f knee(stance_.knee_x[i], y, 0.49f);
    const Vector3f ankle(stance_.ankle_x[i], 1.02f * y, stance_.ankle_z[i]);
    const Vector3f calf = 0.65f * knee + 0.35f * ankle;
    const std::array<Vector3f, 6> joints{hip,
                                         0.5f * (hip + knee),
                                         knee,
                                         calf - Vector3f(0.015f, 0.0f, 0.0f),
                                         0.2f * knee + 0.8f * ankle,
                                         ankle};
    const std::array<float, 6> radii{
        0.094f, 0.083f, 0.065f, 0.064f, 0.053f, 0.055f};
    trousers->Limb(joints, radii, 14);

    // The shoe, from heel to toe, as upright rings.
    const Vector3f toe(0.16f, 0.0f, -stance_.toe_drop[i]);
    const Vector3f heel_to_toe =
        Vector3f(0.245f, 0.0f, -1.5f * stance_.toe_drop[i]);
    const Vector3f sole = ankle - Vector3f(0.0f, 0.0f, 0.08f);
    const Vector3f heel = sole + toe - heel_to_toe;
    struct Station {
      float along;
      float width;
      float height;
    };
    std::vector<Ring> rings;
    for (const Station& station : {Station{0.0f, 0.001f, 0.02f},
                                   Station{0.04f, 0.034f, 0.042f},
                                   Station{0.25f, 0.038f, 0.048f},
                                   Station{0.5f, 0.04f, 0.042f},
                                   Station{0.75f, 0.047f, 0.032f},
                                   Station{0.93f, 0.038f, 0.026f},
                                   Station{1.0f, 0.001f, 0.018f}}) {
      const Vector3f middle = heel + station.along * heel_to_toe +
                              Vector3f(0.0f, 0.0f, station.height);
      rings.push_back(
          {middle, {0.0f, 0.0f, -station.height}, {0.0f, station.width, 0.0f}});
    }
    shoe->Loft(rings, 12);
  }

  void AddArm(int side, Builder* sleeve, Builder* skin) {
    const auto i = static_cast<std::size_t>(side);
    const float s = SignOf(side);
    const Vector3f top(-0.007f, 0.15f * s, 1.435f);
    const Vector3f shoulder(-0.005f, 0.175f * s, 1.39f);
    const Vector3f elbow(stance_.elbow_x[i], 0.213f * s, 1.13f);
    const Vector3f wrist(stance_.hand_x[i], 0.205f * s, 0.9f);
    const Vector3f upper = 0.55f * shoulder + 0.45f * elbow;
    const Vector3f lower = 0.55f * elbow + 0.45f * wrist;
    if (look_.has_short_sleeves) {
      sleeve->Limb(std::array{top, shoulder, upper},
                   std::array{0.04f, 0.06f, 0.06f},
                   12);
      skin->Limb(std::array{upper, elbow, lower, wrist},
                 std::array{0.046f, 0.041f, 0.039f, 0.027f},
                 12);
    } else {
      sleeve->Limb(std::array{top, shoulder, upper, elbow, lower, wrist},
                   std::array{0.04f, 0.06f, 0.055f, 0.047f, 0.044f, 0.037f},
                   12);
    }
    skin->Ball(wrist + Vector3f(0.01f, 0.0f, -0.065f),
               {0.038f, 0.021f, 0.075f},
               10,
               7);
  }

  void AddTorso(Builder* torso, Builder* trousers) {
    const float b = look_.build;
    torso->Loft(std::array{Level(-0.01f, 0.0f, 1.515f, 0.04f, 0.05f),
                           Level(-0.01f, 0.0f, 1.485f, 0.062f, 0.075f),
                           Level(-0.01f, 0.0f, 1.455f, 0.085f, 0.145f),
                           Level(-0.005f, 0.0f, 1.42f, 0.102f, 0.185f),
                           Level(0.0f, 0.0f, 1.36f, 0.117f, 0.19f),
                           Level(0.005f, 0.0f, 1.27f, 0.122f * b, 0.178f * b),
                           Level(0.005f, 0.0f, 1.17f, 0.117f * b, 0.163f * b),
                           Level(0.005f, 0.0f, 1.08f, 0.114f * b, 0.16f * b),
                           Level(0.0f, 0.0f, 0.99f, 0.118f * b, 0.169f * b),
                           Level(0.0f, 0.0f, 0.9f, 0.122f * b, 0.176f * b),
                           Level(0.0f, 0.0f, 0.87f, 0.12f * b, 0.176f * b)},
                20);
    trousers->Loft(std::array{Level(0.0f, 0.0f, 0.92f, 0.11f * b, 0.16f * b),
                              Level(0.0f, 0.0f, 0.85f, 0.112f, 0.166f),
                              Level(0.0f, 0.0f, 0.78f, 0.08f, 0.14f),
                              Level(0.0f, 0.0f, 0.76f, 0.001f, 0.001f)},
                   16);
  }

  void AddHead(Builder* skin, Builder* face, Builder* hair) {
    skin->Loft(std::array{Level(0.008f, 0.0f, 1.58f, 0.05f, 0.05f),
                          Level(0.0f, 0.0f, 1.53f, 0.052f, 0.054f),
                          Level(-0.01f, 0.0f, 1.47f, 0.06f, 0.068f)},
               14);
    const Vector3f middle(0.014f, 0.0f, 1.628f);
    face->Ball(middle, {0.092f, 0.073f, 0.112f}, 24, 16);
    skin->Ball(middle + Vector3f(0.087f, 0.0f, -0.014f),
               {0.014f, 0.011f, 0.021f},
               8,
               6);
    for (const float side : {-1.0f, 1.0f}) {
      skin->Ball(middle + Vector3f(-0.005f, 0.074f * side, -0.005f),
                 {0.02f, 0.01f, 0.03f},
                 8,
                 6);
    }
    // Hair lies over the head behind a slanting line from brow to nape.
    hair->Ball(middle + Vector3f(-0.021f, 0.0f, 0.03f),
               {0.095f, 0.082f, 0.1f},
               20,
               12);
    if (look_.has_long_hair) {
      hair->Ball(middle + Vector3f(-0.06f, 0.0f, -0.06f),
                 {0.048f, 0.078f, 0.115f},
                 16,
                 10);
    }
  }

  PersonLook look_;
  Stance stance_;
  std::uint32_t surface_;
  Scene* scene_;
  SceneMesh mesh_;
};

// Stretches the mesh upright from the floor to the height, and across to fill
// the cylinder.
void Fit(const PersonOptions& options, SceneMesh* mesh) {
  float low = mesh->positions[0].z();
  float high = low;
  float reach = 0.0f;
  for (const Vector3f& p : mesh->positions) {
    low = std::min(low, p.z());
    high = std::max(high, p.z());
    reach = std::max(reach, p.head<2>().norm());
  }
  const float up = static_cast<float>(options.height) / (high - low);
  const float across = static_cast<float>(options.radius) / reach;
  for (Vector3f& p : mesh->positions) {
    p = {across * p.x(), across * p.y(), up * (p.z() - low)};
  }
}

void CheckRange(const char* field, double value, double low, double high) {
  if (!(value >= low && value <= high)) {
    throw std::invalid_argument(std::string("person: ") + field + " = " +
                                std::to_string(value) + " m, not in [" +
                                std::to_string(low) + ", " +
                                std::to_string(high) + "] m");
  }
}

}  // namespace

void PersonOptions::Check() const {
  CheckRange("height", height, 0.8, 2.3);
  CheckRange("radius", radius, 0.15, 0.5);
}

std::size_t AppendPerson(const std::string& name,
                         const PersonOptions& options,
                         Scene* scene) {
  options.Check();
  const auto surface = static_cast<std::uint32_t>(scene->surfaces.size());
  scene->surfaces.push_back({name, SurfaceKind::kPerson});
  SceneMover mover;
  mover.name = name;
  mover.radius = options.radius;
  mover.height = options.height;
  mover.mesh = Person(options, surface, scene).Build(name);
  Fit(options, &mover.mesh);
  scene->movers.push_back(std::move(mover));
  return scene->movers.size() - 1;
}

}  // namespace waymark
