#include "estimation/camera/camera_parameters.h"

#include <array>
#include <stdexcept>
#include <type_traits>

namespace waymark {
namespace {

struct Kind {
  CameraKind kind;
  std::string_view name;
  std::vector<std::string> parameters;
};

const std::array<Kind, 4>& Kinds() {
  static const std::array<Kind, 4> kKinds{
      Kind{CameraKind::kPerspective,
           "perspective",
           {"fx", "fy", "cx", "cy", "k1", "k2", "p1", "p2", "k3"}},
      Kind{CameraKind::kFisheye,
           "fisheye",
           {"fx", "fy", "cx", "cy", "k1", "k2", "k3", "k4"}},
      Kind{CameraKind::kSphere,
           "sphere",
           {"fx", "fy", "cx", "cy", "xi", "k1", "k2", "p1", "p2", "k3"}},
      Kind{CameraKind::kPanorama, "panorama", {"fx", "fy", "cx", "cy"}}};
  return kKinds;
}

const Kind& Find(CameraKind kind) {
  return Kinds()[static_cast<std::size_t>(kind)];
}

void Append(std::initializer_list<double> more, Eigen::VectorXd* values) {
  Eigen::Index at = values->size();
  values->conservativeResize(at + static_cast<Eigen::Index>(more.size()));
  for (const double value : more) (*values)(at++) = value;
}

}  // namespace

std::string_view NameOf(CameraKind kind) {
  return Find(kind).name;
}

CameraKind CameraKindFromName(std::string_view name) {
  std::string known;
  for (const Kind& kind : Kinds()) {
    if (kind.name == name) return kind.kind;
    known += (known.empty() ? "" : ", ") + std::string(kind.name);
  }
  throw std::invalid_argument("'" + std::string(name) +
                              "' is no camera model; there are: " + known);
}

CameraKind KindOf(const CameraModel& camera) {
  // In the order of the variant.
  constexpr std::array kOrder{CameraKind::kPerspective,
                              CameraKind::kFisheye,
                              CameraKind::kSphere,
                              CameraKind::kPanorama};
  static_assert(kOrder.size() == std::variant_size_v<CameraModel>);
  return kOrder[camera.index()];
}

const std::vector<std::string>& ParameterNames(CameraKind kind) {
  return Find(kind).parameters;
}

Eigen::VectorXd ParametersOf(const CameraModel& camera) {
  return std::visit(
      [](const auto& model) {
        using Model = std::decay_t<decltype(model)>;
        const Intrinsics& k = model.intrinsics();
        Eigen::VectorXd values(4);
        values << k.fx, k.fy, k.cx, k.cy;
        if constexpr (std::is_same_v<Model, SphereCamera>) {
          Append({model.xi()}, &values);
        }
        if constexpr (std::is_same_v<Model, FisheyeCamera>) {
          const auto& c = model.coefficients();
          Append({c[0], c[1], c[2], c[3]}, &values);
        } else if constexpr (!std::is_same_v<Model, PanoramaCamera>) {
          const LensDistortion& d = model.distortion();
          Append({d.k1, d.k2, d.p1, d.p2, d.k3}, &values);
        }
        return values;
      },
      camera);
}

CameraModel CameraFromParameters(CameraKind kind, const Eigen::VectorXd& v) {
  const auto size = static_cast<Eigen::Index>(ParameterNames(kind).size());
  if (v.size() != size) {
    throw std::invalid_argument(std::string(NameOf(kind)) + " takes " +
                                std::to_string(size) + " numbers");
  }
  const Intrinsics k{v(0), v(1), v(2), v(3)};
  const auto lens = [&v](Eigen::Index i) {
    return LensDistortion{v(i), v(i + 1), v(i + 2), v(i + 3), v(i + 4)};
  };
  switch (kind) {
    case CameraKind::kPerspective:
      return PerspectiveCamera(k, lens(4));
    case CameraKind::kFisheye:
      return FisheyeCamera(k, {v(4), v(5), v(6), v(7)});
    case CameraKind::kSphere:
      return SphereCamera(v(4), k, lens(5));
    case CameraKind::kPanorama:
      break;
  }
  return PanoramaCamera(k);
}

}  // namespace waymark
