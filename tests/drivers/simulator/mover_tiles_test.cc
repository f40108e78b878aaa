#include "drivers/simulator/mover_tiles.h"

#include "drivers/simulator/ray_caster.h"
#include "estimation/base/random.h"
#include "tests/support/box_scene.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>
#include <vector>

namespace waymark {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

std::vector<CameraView> AllModels() {
  return {{PerspectiveCamera({90.0, 90.0, 79.5, 59.5}), {160, 120}},
          {FisheyeCamera({45.0, 45.0, 79.5, 59.5}), {160, 120}},
          {SphereCamera(0.9, {60.0, 60.0, 64.0, 64.0}), {129, 129}},
          {PanoramaCamera::WholeTurn({256, 64}, 30.0), {256, 64}}};
}

Isometry3d AnyPose(double reach, Random* random) {
  Isometry3d X = Isometry3d::Identity();
  X.linear() =
      (Eigen::AngleAxisd(random->Uniform(-3.1, 3.1), Vector3d::UnitZ()) *
       Eigen::AngleAxisd(random->Uniform(-3.1, 3.1), Vector3d::UnitX()))
          .toRotationMatrix();
  for (int i = 0; i < 3; ++i) {
    X.translation()[i] = random->Uniform(-reach, reach);
  }
  return X;
}

// Whether a ray of any pixel of the tile's meets a mover.
std::vector<std::uint8_t> Seen(const RayCaster& caster,
                               const CameraRays& camera,
                               const Isometry3d& X_WC,
                               const std::vector<Isometry3d>& X_WP) {
  const auto placement = caster.Place(X_WP);
  std::vector<std::uint8_t> seen(camera.cones().size(), 0);
  RayPacket rays;
  SetOrigin(X_WC.translation().cast<float>(), &rays);
  for (int row = 0; row < camera.num_block_rows(); ++row) {
    for (int column = 0; column < camera.num_block_columns(); ++column) {
      const CameraRays::Block& block = camera.block(row, column);
      for (int lane = 0; lane < RayPacket::kLanes; ++lane) {
        const Eigen::Vector3f d = X_WC.linear().cast<float>() *
                                  Eigen::Vector3f(block.direction[0][lane],
                                                  block.direction[1][lane],
                                                  block.direction[2][lane]);
        for (int i = 0; i < 3; ++i) rays.direction[i][lane] = d[i];
      }
      rays.active = block.valid;
      caster.Trace(&rays, &placement);
      for (int lane = 0; lane < RayPacket::kLanes; ++lane) {
        if (rays.triangle[lane] == RayPacket::kNothing ||
            rays.mover[lane] == RayPacket::kStatic) {
          continue;
        }
        seen[camera.TileOf(column * CameraRays::kBlockWidth,
                           row * CameraRays::kBlockHeight)] = 1;
      }
    }
  }
  return seen;
}

TEST(MoverTiles, NoTileWithAMoverIsLeftOutAndFewWithout) {
  Scene scene = FurnishedCorridor();
  scene.mesh = {};
  const RayCaster caster(scene);
  const MoverTiles tiles(scene);
  Random random(5);
  int num_near = 0;
  int num_seen = 0;
  int num_all = 0;
  for (const CameraView& view : AllModels()) {
    const CameraRays camera(view);
    for (int i = 0; i < 40; ++i) {
      // Within a metre: often inside the mover, too.
      const Isometry3d X_WC = AnyPose(0.3, &random);
      const std::vector<Isometry3d> X_WP{AnyPose(i < 4 ? 0.3 : 4.0, &random)};
      const auto near = tiles.Near(camera, X_WC, X_WP);
      const auto seen = Seen(caster, camera, X_WC, X_WP);
      ASSERT_EQ(near.size(), seen.size());
      for (std::size_t tile = 0; tile < near.size(); ++tile) {
        ASSERT_GE(near[tile], seen[tile]) << i << ' ' << tile;
        num_near += near[tile];
        num_seen += seen[tile];
        ++num_all;
      }
    }
  }
  EXPECT_GT(num_seen, 100);
  // Tiles about the outline and the room of the balls.
  EXPECT_LT(num_near, num_all / 2);
  EXPECT_LT(num_near, 4 * num_seen);
}

TEST(MoverTiles, WithoutMoversNoTileHasOne) {
  const CameraRays camera(AllModels()[0]);
  const auto near =
      MoverTiles(Scene{}).Near(camera, Isometry3d::Identity(), {});
  EXPECT_EQ(std::count(near.begin(), near.end(), 1), 0);
  EXPECT_THROW((void)MoverTiles(FurnishedCorridor())
                   .Near(camera, Isometry3d::Identity(), {}),
               std::logic_error);
}

}  // namespace
}  // namespace waymark
