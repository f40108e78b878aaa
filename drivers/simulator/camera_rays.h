// The rays of all pixels of a camera, computed once.
#pragma once

#include "estimation/camera/camera_model.h"
#include "estimation/camera/image_remap.h"

#include <Eigen/Core>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace waymark {

// Blocks of 4 x 2 pixels, row by row, which are traced together, in tiles of
// 16 x 16. Costs 320 bytes for 8 pixels and one RayFromPixel a pixel.
class CameraRays {
 public:
  static constexpr int kBlockWidth = 4;
  static constexpr int kBlockHeight = 2;
  static constexpr int kLanes = kBlockWidth * kBlockHeight;
  using Lanes = float[kLanes];

  // Lane 4 y + x of each is the pixel (x, y) of the block.
  struct alignas(32) Block {
    Lanes direction[3];  // Unit bearing n_C of the pixel's centre.
    Lanes d_x[3];        // Its change to the next pixel right,
    Lanes d_y[3];        // and below.
    // Bit i: lane i lies in the image and the model has a ray for it.
    std::uint32_t valid = 0;
  };

  // A cone about all rays through the pixels of a tile, borders included.
  struct Cone {
    Eigen::Vector3f axis_C = Eigen::Vector3f::UnitZ();
    float half_angle = -1.0f;  // Below 0: the tile has no rays.
  };
  static constexpr int kTileSize = 16;  // Pixels: whole blocks.

  // Throws std::invalid_argument where the size is not positive.
  explicit CameraRays(const CameraView& view);

  [[nodiscard]] const CameraView& view() const { return view_; }
  [[nodiscard]] const ImageSize& size() const { return view_.size; }
  [[nodiscard]] int num_block_columns() const { return num_columns_; }
  [[nodiscard]] int num_block_rows() const { return num_rows_; }
  [[nodiscard]] const Block& block(int row, int column) const {
    return blocks_[static_cast<std::size_t>(row) *
                       static_cast<std::size_t>(num_columns_) +
                   static_cast<std::size_t>(column)];
  }
  [[nodiscard]] const std::vector<Cone>& cones() const { return cones_; }
  // Index of `cones` for a pixel.
  [[nodiscard]] std::size_t TileOf(int x, int y) const {
    return static_cast<std::size_t>(y / kTileSize) * tiles_per_row_ +
           static_cast<std::size_t>(x / kTileSize);
  }

 private:
  void MakeCones();

  CameraView view_;
  int num_columns_ = 0;
  int num_rows_ = 0;
  std::vector<Block> blocks_;
  std::size_t tiles_per_row_ = 0;
  std::vector<Cone> cones_;
};

}  // namespace waymark
