#include "estimation/camera/camera_parameters.h"

#include <array>
#include <cmath>
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

// Derivative of the point of the plane, to be multiplied by the focal lengths,
// by the numbers behind the four intrinsics.
ParameterJacobian PlaneByLens(const PerspectiveCamera&,
                              const Eigen::Vector3d& point) {
  return DistortedByCoefficients(point.head<2>() / point.z());
}

ParameterJacobian PlaneByLens(const FisheyeCamera&,
                              const Eigen::Vector3d& point) {
  const double r = point.head<2>().norm();
  ParameterJacobian d = ParameterJacobian::Zero(2, 4);
  if (!(r > 0.0)) return d;
  const double angle = std::atan2(r, point.z());
  double power = angle;
  for (Eigen::Index i = 0; i < d.cols(); ++i) {
    power *= angle * angle;
    d.col(i) = power / r * point.head<2>();
  }
  return d;
}

ParameterJacobian PlaneByLens(const SphereCamera& camera,
                              const Eigen::Vector3d& point) {
  const Eigen::Vector3d n = point.normalized();
  const double depth = n.z() + camera.xi();
  const Eigen::Vector2d plane = n.head<2>() / depth;
  ParameterJacobian d(2, 6);
  d << Distort(camera.distortion(), plane).d_point * (-plane / depth),
      DistortedByCoefficients(plane);
  return d;
}

ParameterJacobian PlaneByLens(const PanoramaCamera&, const Eigen::Vector3d&) {
  return ParameterJacobian(2, 0);
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

std::optional<ParameterJacobian> PixelByParameters(
    const CameraModel& camera, const Eigen::Vector3d& point) {
  const auto seen = ExtendedPixelFromRay(camera, point);
  if (!seen) return std::nullopt;
  return std::visit(
      [&](const auto& model) {
        const Intrinsics& k = model.intrinsics();
        const ParameterJacobian lens = PlaneByLens(model, point);
        ParameterJacobian d(2, 4 + lens.cols());
        d << (seen->pixel.x() - k.cx) / k.fx, 0.0, 1.0, 0.0,
            k.fx * lens.row(0),  //
            0.0, (seen->pixel.y() - k.cy) / k.fy, 0.0, 1.0, k.fy * lens.row(1);
        return d;
      },
      camera);
}

}  // namespace waymark
