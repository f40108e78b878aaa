#include "drivers/simulator/build_furniture.h"

#include "drivers/simulator/build_rooms.h"
#include "drivers/simulator/mesh_builder.h"
#include "estimation/base/random.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace waymark {
namespace {

// Colours of books, cushions and screens, BGR.
const std::array<cv::Vec3b, 10>& BookColors() {
  static const std::array<cv::Vec3b, 10> kColors{cv::Vec3b(48, 52, 140),
                                                 cv::Vec3b(120, 84, 40),
                                                 cv::Vec3b(70, 110, 60),
                                                 cv::Vec3b(60, 150, 196),
                                                 cv::Vec3b(190, 200, 206),
                                                 cv::Vec3b(92, 60, 92),
                                                 cv::Vec3b(54, 50, 48),
                                                 cv::Vec3b(150, 132, 84),
                                                 cv::Vec3b(44, 92, 168),
                                                 cv::Vec3b(128, 120, 116)};
  return kColors;
}

// One piece of furniture in its own frame: x to its front, y to its left, z
// up from its base.
class Piece {
 public:
  Piece(const WorldFurniture& piece, Finishes* finishes, Scene* scene)
      : piece_(piece),
        finishes_(*finishes),
        scene_(*scene),
        random_(piece.seed),
        builder_(
            &scene->mesh,
            AddSurface(NameOf(piece.kind), SurfaceKind::kFurniture, scene)),
        depth_(piece.size.x()),
        width_(piece.size.y()),
        height_(piece.size.z()) {
    X_WB_.translation() << piece.at, piece.z;
    X_WB_.linear() = Eigen::AngleAxisd(piece.heading, Eigen::Vector3d::UnitZ())
                         .toRotationMatrix();
  }

  void Build() {
    switch (piece_.kind) {
      case FurnitureKind::kDesk:
        return Desk();
      case FurnitureKind::kTable:
        return Table();
      case FurnitureKind::kChair:
        return Chair();
      case FurnitureKind::kCabinet:
        return Cabinet();
      case FurnitureKind::kShelf:
        return Shelf();
      case FurnitureKind::kSofa:
        return Sofa();
      case FurnitureKind::kPlant:
        return Plant();
      case FurnitureKind::kBin:
        return Bin();
      case FurnitureKind::kBox:
        return Box(
            {-depth_ / 2.0, -width_ / 2.0, 0.0},
            {depth_ / 2.0, width_ / 2.0, height_},
            Main("carton"),
            kAllFaces & ~static_cast<unsigned>(piece_.z > 0.0 ? 0u : kBottom));
    }
  }

 private:
  Finish Main(const std::string& usual) {
    return finishes_.Get(piece_.material.empty() ? usual : piece_.material,
                         piece_.where,
                         "material");
  }
  Finish Named(const std::string& name) {
    return finishes_.Get(name, piece_.where, "material");
  }

  void Box(const Eigen::Vector3d& low,
           const Eigen::Vector3d& high,
           const Finish& finish,
           unsigned faces = kAllFaces) {
    builder_.AddBox(X_WB_, low, high, finish, faces);
  }

  void Column(const Eigen::Vector3d& base,
              double height,
              double radius_low,
              double radius_high,
              int sides,
              const Finish& finish) {
    builder_.AddColumn(X_WB_ * Eigen::Translation3d(base),
                       0.0,
                       height,
                       radius_low,
                       radius_high,
                       sides,
                       finish);
  }

  // Sides on the floor with a top over them, drawers at the right, a screen and
  // a keyboard; its user sits at its front.
  void Desk() {
    const Finish wood = Main("wood");
    const Finish metal = Named("metal");
    const double x = depth_ / 2.0;
    const double y = width_ / 2.0;
    const double top = height_ - 0.03;
    Box({-x, -y, top}, {x, y, height_}, wood);
    Box({-x + 0.03, y - 0.05, 0.0}, {x - 0.05, y - 0.02, top}, metal);
    Box({-x + 0.03, -y + 0.02, 0.0}, {x - 0.05, -y + 0.05, top}, metal);
    Box({-x + 0.06, -y + 0.05, 0.3}, {-x + 0.08, y - 0.05, top}, metal);
    const double inner = -y + 0.05;
    const double outer = std::min(-y + 0.47, y - 0.1);
    Box({-x + 0.12, inner, 0.08}, {x - 0.08, outer, top}, wood);
    const double drawer = (top - 0.1) / 3.0;
    for (int i = 0; i < 3; ++i) {
      const double z = 0.1 + drawer * i;
      Box({x - 0.08, inner + 0.01, z},
          {x - 0.06, outer - 0.01, z + drawer - 0.02},
          wood);
      const double middle = (inner + outer) / 2.0;
      const double handle = z + drawer - 0.06;
      Box({x - 0.06, middle - 0.06, handle},
          {x - 0.045, middle + 0.06, handle + 0.015},
          metal);
    }
    if (depth_ >= 0.6 && width_ >= 1.0) Screen();
  }

  void Screen() {
    const Finish dark = Named("dark");
    const double z = height_;
    const double y = random_.Uniform(0.0, 0.15 * width_);
    const double x = -0.2 * depth_;
    Box({x - 0.1, y - 0.12, z}, {x + 0.1, y + 0.12, z + 0.012}, dark);
    Box({x - 0.02, y - 0.03, z + 0.012}, {x, y + 0.03, z + 0.2}, dark);
    Box({x, y - 0.27, z + 0.1}, {x + 0.025, y + 0.27, z + 0.43}, dark);
    Box({x + 0.025, y - 0.255, z + 0.115},
        {x + 0.027, y + 0.255, z + 0.415},
        finishes_.Plain({120, 96, 62}),
        kFront);
    Box({x + 0.2, y - 0.22, z}, {x + 0.34, y + 0.22, z + 0.02}, dark);
    const double sheet_y = -0.32 * width_;
    Box({-0.1, sheet_y - 0.105, z},
        {0.197, sheet_y + 0.105, z + 0.01},
        finishes_.Plain({226, 230, 232}));
  }

  void Table() {
    const Finish wood = Main("wood");
    const double x = depth_ / 2.0;
    const double y = width_ / 2.0;
    const double top = height_ - 0.03;
    Box({-x, -y, top}, {x, y, height_}, wood);
    Box({-x + 0.08, -y + 0.08, top - 0.07}, {x - 0.08, y - 0.08, top}, wood);
    for (const double lx : {-x + 0.04, x - 0.1}) {
      for (const double ly : {-y + 0.04, y - 0.1}) {
        Box({lx, ly, 0.0}, {lx + 0.06, ly + 0.06, top}, wood);
      }
    }
  }

  // Five feet, a column, a seat, a back.
  void Chair() {
    const Finish cloth = Main("fabric");
    const Finish dark = Named("dark");
    const double seat = 0.5 * height_;
    const double reach = std::min(depth_, width_) / 2.0;
    for (int i = 0; i < 5; ++i) {
      const double angle = 2.0 * std::numbers::pi * i / 5.0;
      const Eigen::Isometry3d X_WF =
          X_WB_ * Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitZ());
      builder_.AddBox(
          X_WF, {0.0, -0.02, 0.06}, {reach - 0.03, 0.02, 0.09}, dark);
      builder_.AddBox(
          X_WF, {reach - 0.07, -0.02, 0.0}, {reach - 0.02, 0.02, 0.06}, dark);
    }
    Column({0.0, 0.0, 0.06}, seat - 0.1, 0.03, 0.03, 8, Named("metal"));
    const double x = 0.46 * depth_;
    const double y = 0.46 * width_;
    Box({-x, -y, seat - 0.05}, {x, y, seat + 0.03}, cloth);
    Box({-x - 0.02, -0.03, seat - 0.03}, {-x, 0.03, seat + 0.25}, dark);
    Box({-x, -0.9 * y, seat + 0.14}, {-x + 0.06, 0.9 * y, height_}, cloth);
    for (const double side : {-1.0, 1.0}) {
      const double arm = side * (y + 0.01);
      Box({-0.05, arm - 0.015, seat - 0.03},
          {0.0, arm + 0.015, seat + 0.2},
          dark);
      Box({-0.12, arm - 0.025, seat + 0.2},
          {0.14, arm + 0.025, seat + 0.23},
          dark);
    }
  }

  void Cabinet() {
    const Finish body = Main("wood");
    const Finish metal = Named("metal");
    const double x = depth_ / 2.0;
    const double y = width_ / 2.0;
    Box({-x + 0.01, -y + 0.02, 0.0}, {x - 0.05, y - 0.02, 0.06}, Named("dark"));
    Box({-x, -y, 0.06}, {x - 0.02, y, height_}, body);
    const int doors = std::max(1, static_cast<int>(std::round(width_ / 0.5)));
    const double door = width_ / doors;
    for (int i = 0; i < doors; ++i) {
      const double begin = -y + door * i + 0.004;
      const double end = -y + door * (i + 1) - 0.004;
      Box({x - 0.02, begin, 0.07}, {x, end, height_ - 0.01}, body);
      const double handle = i % 2 == 0 ? end - 0.05 : begin + 0.035;
      const double z = std::min(1.0, 0.6 * height_);
      Box({x, handle, z - 0.08}, {x + 0.02, handle + 0.015, z + 0.08}, metal);
    }
  }

  void Shelf() {
    const Finish wood = Main("wood");
    const double x = depth_ / 2.0;
    const double y = width_ / 2.0;
    constexpr double kBoard = 0.022;
    Box({-x, -y, 0.0}, {x, -y + kBoard, height_}, wood);
    Box({-x, y - kBoard, 0.0}, {x, y, height_}, wood);
    Box({-x, -y + kBoard, 0.0}, {-x + 0.008, y - kBoard, height_}, wood);
    const int boards = std::max(2, static_cast<int>(height_ / 0.36) + 1);
    const double step = (height_ - 0.06 - kBoard) / (boards - 1);
    for (int i = 0; i < boards; ++i) {
      const double z = 0.06 + step * i;
      Box({-x + 0.008, -y + kBoard, z}, {x, y - kBoard, z + kBoard}, wood);
      if (i + 1 < boards) Books(z + kBoard, step - kBoard);
    }
  }

  // A row of books, with gaps, on a board at z.
  void Books(double z, double room) {
    const double x = depth_ / 2.0;
    const double end = width_ / 2.0 - 0.03;
    double y = -width_ / 2.0 + 0.03;
    while (y < end - 0.02) {
      const double thick = random_.Uniform(0.018, 0.06);
      const bool is_gap = random_.Uniform() < 0.12;
      if (!is_gap && y + thick < end) {
        const double high = room * random_.Uniform(0.6, 0.93);
        const double front = x - random_.Uniform(0.02, 0.3 * depth_);
        Box({-x + 0.02, y, z},
            {front, y + thick - 0.001, z + high},
            finishes_.Plain(BookColors()[random_.Index(BookColors().size())]),
            kAllFaces & ~static_cast<unsigned>(kBottom | kBack));
      }
      y += is_gap ? random_.Uniform(0.05, 0.2) : thick;
    }
  }

  void Sofa() {
    const Finish cloth = Main("fabric");
    const Finish dark = Named("dark");
    const double x = depth_ / 2.0;
    const double y = width_ / 2.0;
    const double seat = 0.52 * height_;
    const double arm = 0.16;
    for (const double fx : {-x + 0.05, x - 0.11}) {
      for (const double fy : {-y + 0.05, y - 0.11}) {
        Box({fx, fy, 0.0}, {fx + 0.06, fy + 0.06, 0.1}, dark);
      }
    }
    Box({-x, -y, 0.1}, {x - 0.02, y, 0.55 * seat}, cloth);
    Box({-x, -y, 0.55 * seat}, {-x + 0.2, y, height_}, cloth);
    Box({-x + 0.2, -y, 0.55 * seat},
        {x - 0.02, -y + arm, 0.75 * height_},
        cloth);
    Box({-x + 0.2, y - arm, 0.55 * seat}, {x - 0.02, y, 0.75 * height_}, cloth);
    const int cushions =
        std::max(1, static_cast<int>(std::round(width_ / 0.7)));
    const double wide = (width_ - 2.0 * arm) / cushions;
    for (int i = 0; i < cushions; ++i) {
      const double begin = -y + arm + wide * i + 0.006;
      const double end = begin + wide - 0.012;
      Box({-x + 0.2, begin, 0.55 * seat}, {x, end, seat}, cloth);
      Box({-x + 0.2, begin, seat}, {-x + 0.36, end, 0.95 * height_}, cloth);
    }
  }

  // A pot of earth with blades that bend outward.
  void Plant() {
    const double radius = 0.5 * std::min(depth_, width_);
    const double pot = 0.28 * height_;
    Column(
        {0.0, 0.0, 0.0}, pot, 0.5 * radius, 0.7 * radius, 14, Main("carton"));
    Column({0.0, 0.0, pot},
           0.004,
           0.64 * radius,
           0.64 * radius,
           14,
           finishes_.Plain({38, 50, 62}));
    const std::array<Finish, 3> greens{finishes_.Plain({52, 110, 62}),
                                       finishes_.Plain({58, 132, 80}),
                                       finishes_.Plain({44, 92, 50})};
    const int leaves = 34;
    for (int i = 0; i < leaves; ++i) {
      const Finish& green = greens[random_.Index(greens.size())];
      const double rise = (height_ - pot) * random_.Uniform(0.45, 1.0);
      const double reach = radius * random_.Uniform(0.55, 1.0);
      // The golden angle: no two above each other.
      Leaf(2.399963 * i, pot, reach, rise, green);
    }
  }

  // Three segments from the pot's middle up and outward to `reach`.
  void Leaf(double angle,
            double z,
            double reach,
            double height,
            const Finish& finish) {
    const Eigen::Isometry3d X_WL =
        X_WB_ * Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitZ());
    const std::array<double, 4> along{0.05, 0.3, 0.68, 1.0};
    const std::array<double, 4> up{0.0, 0.62, 1.0, 0.86};
    const std::array<double, 4> half{0.012, 0.035, 0.04, 0.002};
    for (std::size_t i = 0; i + 1 < along.size(); ++i) {
      const auto at = [&](std::size_t k, double side) -> Eigen::Vector3d {
        return X_WL * Eigen::Vector3d(
                          along[k] * reach, side * half[k], z + up[k] * height);
      };
      builder_.AddPanel(
          {at(i, -1.0), at(i, 1.0), at(i + 1, 1.0), at(i + 1, -1.0)}, finish);
    }
  }

  void Bin() {
    const double radius = 0.5 * std::min(depth_, width_);
    const Finish finish = Main("dark");
    Column({0.0, 0.0, 0.0},
           height_ - 0.01,
           0.8 * radius,
           0.97 * radius,
           18,
           finish);
    Column({0.0, 0.0, height_ - 0.01}, 0.01, radius, radius, 18, finish);
  }

  const WorldFurniture& piece_;
  Finishes& finishes_;
  Scene& scene_;
  Random random_;
  MeshBuilder builder_;
  Eigen::Isometry3d X_WB_ = Eigen::Isometry3d::Identity();
  double depth_;
  double width_;
  double height_;
};

}  // namespace

std::string NameOf(FurnitureKind kind) {
  switch (kind) {
    case FurnitureKind::kDesk:
      return "desk";
    case FurnitureKind::kTable:
      return "table";
    case FurnitureKind::kChair:
      return "chair";
    case FurnitureKind::kCabinet:
      return "cabinet";
    case FurnitureKind::kShelf:
      return "shelf";
    case FurnitureKind::kSofa:
      return "sofa";
    case FurnitureKind::kPlant:
      return "plant";
    case FurnitureKind::kBin:
      return "bin";
    case FurnitureKind::kBox:
      return "box";
  }
  return "unknown";
}

Eigen::Vector3d UsualSize(FurnitureKind kind) {
  switch (kind) {
    case FurnitureKind::kDesk:
      return {0.8, 1.6, 0.74};
    case FurnitureKind::kTable:
      return {0.9, 1.8, 0.74};
    case FurnitureKind::kChair:
      return {0.6, 0.6, 1.0};
    case FurnitureKind::kCabinet:
      return {0.45, 1.0, 1.9};
    case FurnitureKind::kShelf:
      return {0.32, 0.9, 2.0};
    case FurnitureKind::kSofa:
      return {0.9, 1.9, 0.8};
    case FurnitureKind::kPlant:
      return {0.7, 0.7, 1.4};
    case FurnitureKind::kBin:
      return {0.3, 0.3, 0.4};
    case FurnitureKind::kBox:
      return {0.4, 0.6, 0.4};
  }
  return {1.0, 1.0, 1.0};
}

void BuildFurniture(const WorldFurniture& piece,
                    Finishes* finishes,
                    Scene* scene) {
  Piece(piece, finishes, scene).Build();
}

}  // namespace waymark
