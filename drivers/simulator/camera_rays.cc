#include "drivers/simulator/camera_rays.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace waymark {
namespace {

void SetLane(const BackProjection& ray, int lane, CameraRays::Block* block) {
  for (int axis = 0; axis < 3; ++axis) {
    block->direction[axis][lane] = static_cast<float>(ray.ray(axis));
    block->d_x[axis][lane] = static_cast<float>(ray.d_pixel(axis, 0));
    block->d_y[axis][lane] = static_cast<float>(ray.d_pixel(axis, 1));
  }
  block->valid |= 1u << lane;
}

}  // namespace

CameraRays::CameraRays(const CameraView& view) : view_(view) {
  if (view.size.width <= 0 || view.size.height <= 0) {
    throw std::invalid_argument("camera rays: the size must be positive");
  }
  num_columns_ = (view.size.width + kBlockWidth - 1) / kBlockWidth;
  num_rows_ = (view.size.height + kBlockHeight - 1) / kBlockHeight;
  blocks_.resize(static_cast<std::size_t>(num_columns_) *
                 static_cast<std::size_t>(num_rows_));
  for (int y = 0; y < view.size.height; ++y) {
    for (int x = 0; x < view.size.width; ++x) {
      const auto ray = RayFromPixel(view.model, {x, y});
      if (!ray) continue;
      Block& block = blocks_[static_cast<std::size_t>(y / kBlockHeight) *
                                 static_cast<std::size_t>(num_columns_) +
                             static_cast<std::size_t>(x / kBlockWidth)];
      SetLane(*ray, kBlockWidth * (y % kBlockHeight) + x % kBlockWidth, &block);
    }
  }
  MakeCones();
}

void CameraRays::MakeCones() {
  const auto tiles = [](int pixels) {
    return static_cast<std::size_t>((pixels + kTileSize - 1) / kTileSize);
  };
  tiles_per_row_ = tiles(view_.size.width);
  const std::size_t num = tiles_per_row_ * tiles(view_.size.height);
  std::vector<Eigen::Vector3f> sums(num, Eigen::Vector3f::Zero());
  const auto for_each_ray = [&](const auto& visit) {
    for (int row = 0; row < num_rows_; ++row) {
      for (int column = 0; column < num_columns_; ++column) {
        const Block& b = block(row, column);
        const std::size_t tile =
            TileOf(column * kBlockWidth, row * kBlockHeight);
        for (int i = 0; i < kLanes; ++i) {
          if ((b.valid >> i & 1u) == 0) continue;
          visit(tile, b, i);
        }
      }
    }
  };
  const auto lane_of = [](const Lanes(&values)[3], int i) {
    return Eigen::Vector3f(values[0][i], values[1][i], values[2][i]);
  };
  for_each_ray([&](std::size_t tile, const Block& b, int i) {
    sums[tile] += lane_of(b.direction, i);
  });
  std::vector<float> chords(num, -1.0f);
  std::vector<float> steps(num, 0.0f);
  cones_.resize(num);
  for (std::size_t i = 0; i < num; ++i) {
    if (sums[i].norm() > 0.0f) cones_[i].axis_C = sums[i].normalized();
  }
  for_each_ray([&](std::size_t tile, const Block& b, int i) {
    const Eigen::Vector3f off = lane_of(b.direction, i) - cones_[tile].axis_C;
    chords[tile] = std::max(chords[tile], off.norm());
    steps[tile] = std::max(steps[tile],
                           lane_of(b.d_x, i).norm() + lane_of(b.d_y, i).norm());
  });
  for (std::size_t i = 0; i < num; ++i) {
    if (chords[i] < 0.0f) continue;
    // A pixel's corner is half a step each way from its centre: the other half
    // is room for bends and roundings.
    cones_[i].half_angle =
        2.0f * std::asin(std::min(1.0f, 0.5f * chords[i])) + steps[i];
  }
}

}  // namespace waymark
