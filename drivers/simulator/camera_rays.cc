#include "drivers/simulator/camera_rays.h"

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
}

}  // namespace waymark
