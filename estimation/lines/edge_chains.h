// Straight pieces of edges by following them from pixel to pixel.
#pragma once

#include "estimation/lines/edge_image.h"
#include "estimation/lines/line_parts.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace waymark {

struct EdgeChainOptions {
  // A pixel joins while its gradient turns no further than this from the mean
  // of the piece, in (0, 1.5], and its centre lies this close to its line.
  double max_turn_rad = 0.4;
  double max_distance_px = 1.1;
  int min_pixels = 6;  // Shorter pieces are left out; at least 2.

  // Throws std::invalid_argument naming the first field out of range.
  void Check() const;
};

// From each edge pixel that is left, in the order of rows, both ways along the
// edge; single missing pixels are stepped over. Where the next pixel leaves
// the line the piece ends and another begins. Each pixel belongs to one piece
// at most. An alternative to the paper's tiles for images with gradients: the
// gradient tells parallel edges apart that share a tile, and crossings cut
// nothing. Time is proportional to the number of edge pixels.
class EdgeChainFinder {
 public:
  explicit EdgeChainFinder(const EdgeChainOptions& options = {});

  // `edges` with gradients.
  void Find(const EdgeImage& edges, LineParts* parts);

 private:
  struct Pixel {
    int x;
    int y;
  };

  [[nodiscard]] std::size_t CellOf(int x, int y) const;
  void Take(const Pixel& pixel);
  void Grow(const Pixel& seed);
  // Extends from `end` along (sign = 1) or against the piece's direction.
  void Walk(Pixel end, int sign, std::vector<Pixel>* out);
  [[nodiscard]] bool Next(const Pixel& end, int sign, Pixel* next) const;
  [[nodiscard]] bool Fits(int x, int y, double* distance) const;
  void Emit(LineParts* parts) const;

  EdgeChainOptions options_;
  double min_cosine_squared_ = 0.0;
  const EdgeImage* edges_ = nullptr;
  // Of each pixel whether it is an edge that no piece has; with a rim, so that
  // what is two pixels away needs no check.
  std::vector<std::uint8_t> free_;
  std::ptrdiff_t pitch_ = 0;
  std::vector<Pixel> forward_;
  std::vector<Pixel> backward_;
  // Of the piece that grows.
  double gradient_x_ = 0.0;
  double gradient_y_ = 0.0;
  double least_square_ = 0.0;  // Of its length, times min_cosine_squared_.
  LineMoments moments_;
  LineFit fit_;
  double next_fit_ = 0.0;  // Number of pixels at which the line is fitted.
};

}  // namespace waymark
