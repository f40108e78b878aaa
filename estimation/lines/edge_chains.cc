#include "estimation/lines/edge_chains.h"

#include "estimation/base/check.h"

#include <array>
#include <bit>
#include <cmath>
#include <cstdlib>
#include <stdexcept>

namespace waymark {
namespace {

// Below this many pixels the gradients tell the direction better than the
// pixels' centres.
constexpr double kFirstFit = 8.0;
// The line is fitted again each time the piece has grown by a quarter.
constexpr double kGrowth = 1.25;
// As far as a step over a gap may lead.
constexpr int kRim = 2;

template <typename Visit>
void ForEachEdge(const EdgeImage& edges, const Visit& visit) {
  const std::uint64_t* word = edges.bits.data();
  for (int y = 0; y < edges.height; ++y) {
    for (int first = 0; first < 64 * edges.num_words; first += 64) {
      for (std::uint64_t bits = *word++; bits != 0; bits &= bits - 1) {
        visit(first + std::countr_zero(bits), y);
      }
    }
  }
}

}  // namespace

void EdgeChainOptions::Check() const {
  if (!(max_turn_rad > 0.0) || !(max_turn_rad <= 1.5)) {
    throw std::invalid_argument("max_turn_rad must be in (0, 1.5]");
  }
  if (!(max_distance_px > 0.0) || !(max_distance_px <= 10.0)) {
    throw std::invalid_argument("max_distance_px must be in (0, 10]");
  }
  if (min_pixels < 2) throw std::invalid_argument("min_pixels: at least 2");
}

EdgeChainFinder::EdgeChainFinder(const EdgeChainOptions& options)
    : options_(options) {
  options.Check();
  const double cosine = std::cos(options.max_turn_rad);
  min_cosine_squared_ = cosine * cosine;
}

inline std::size_t EdgeChainFinder::CellOf(int x, int y) const {
  return static_cast<std::size_t>((y + kRim) * pitch_ + x + kRim);
}

void EdgeChainFinder::Take(const Pixel& pixel) {
  free_[CellOf(pixel.x, pixel.y)] = 0;
  const std::size_t i = edges_->IndexOf(pixel.x, pixel.y);
  gradient_x_ += edges_->dx[i];
  gradient_y_ += edges_->dy[i];
  least_square_ = min_cosine_squared_ *
                  (gradient_x_ * gradient_x_ + gradient_y_ * gradient_y_);
  moments_.Add(pixel.x, pixel.y);
  if (moments_.n >= next_fit_) {
    fit_ = moments_.Fit();
    next_fit_ = kGrowth * moments_.n;
  }
}

inline bool EdgeChainFinder::Fits(int x, int y, double* distance) const {
  if (free_[CellOf(x, y)] == 0) return false;
  const std::size_t i = edges_->IndexOf(x, y);
  const double dx = edges_->dx[i];
  const double dy = edges_->dy[i];
  const double dot = dx * gradient_x_ + dy * gradient_y_;
  if (dot <= 0.0) return false;
  if (dot * dot < least_square_ * (dx * dx + dy * dy)) return false;
  *distance = moments_.n < kFirstFit
                  ? 0.0
                  : std::abs(fit_.Distance(Eigen::Vector2d(x, y)));
  return *distance <= options_.max_distance_px;
}

// Walking along (dy, -dx) of the gradient has the brighter side on the right.
bool EdgeChainFinder::Next(const Pixel& end, int sign, Pixel* next) const {
  const double along_x = sign * gradient_y_;
  const double along_y = -sign * gradient_x_;
  const bool is_flat = std::abs(along_x) >= std::abs(along_y);
  const int step = (is_flat ? along_x : along_y) >= 0.0 ? 1 : -1;
  const int lean = (is_flat ? along_y : along_x) >= 0.0 ? 1 : -1;
  // Groups of steps along and aside. Straight on, to the side where the edge
  // leans, to the other; beside, where the edge is steep and its pixels stand
  // two in a column; then over a gap.
  struct Step {
    int along;
    int aside;
  };
  constexpr std::array<Step, 8> kSteps{
      {{1, 0}, {1, 1}, {1, -1}, {0, 1}, {2, 1}, {2, 0}, {2, 2}, {2, -1}}};
  constexpr std::array<std::size_t, 4> kGroups{0, 3, 4, 8};
  for (std::size_t group = 0; group + 1 < kGroups.size(); ++group) {
    double least = 0.0;
    bool has_next = false;
    for (std::size_t i = kGroups[group]; i < kGroups[group + 1]; ++i) {
      const int along = kSteps[i].along * step;
      const int aside = kSteps[i].aside * lean;
      const Pixel pixel = is_flat ? Pixel{end.x + along, end.y + aside}
                                  : Pixel{end.x + aside, end.y + along};
      double distance = 0.0;
      if (!Fits(pixel.x, pixel.y, &distance)) continue;
      if (has_next && distance >= least) continue;
      least = distance;
      has_next = true;
      *next = pixel;
    }
    if (has_next) return true;
  }
  return false;
}

void EdgeChainFinder::Walk(Pixel end, int sign, std::vector<Pixel>* out) {
  out->clear();
  Pixel next{};
  while (Next(end, sign, &next)) {
    Take(next);
    out->push_back(next);
    end = next;
  }
}

void EdgeChainFinder::Grow(const Pixel& seed) {
  gradient_x_ = 0.0;
  gradient_y_ = 0.0;
  moments_ = {};
  next_fit_ = kFirstFit;
  Take(seed);
  Walk(seed, 1, &forward_);
  Walk(seed, -1, &backward_);
  backward_.insert(backward_.begin(), seed);
}

void EdgeChainFinder::Emit(LineParts* parts) const {
  LinePart part;
  part.moments = moments_;
  part.first_pixel = static_cast<std::int32_t>(parts->pixels.size());
  const auto add = [&](const Pixel& pixel) {
    parts->pixels.emplace_back(static_cast<float>(pixel.x),
                               static_cast<float>(pixel.y));
  };
  for (auto it = backward_.rbegin(); it != backward_.rend(); ++it) add(*it);
  for (const Pixel& pixel : forward_) add(pixel);
  part.num_pixels =
      static_cast<std::int32_t>(parts->pixels.size()) - part.first_pixel;
  part.a = parts->pixels[static_cast<std::size_t>(part.first_pixel)];
  part.b = parts->pixels.back();
  parts->parts.push_back(part);
}

void EdgeChainFinder::Find(const EdgeImage& edges, LineParts* parts) {
  parts->Clear();
  parts->is_directed = true;
  if (edges.bits.empty()) return;
  WAYMARK_CHECK(!edges.dx.empty());
  edges_ = &edges;
  pitch_ = edges.width + 2 * kRim;
  free_.assign(static_cast<std::size_t>(pitch_ * (edges.height + 2 * kRim)), 0);
  ForEachEdge(edges, [&](int x, int y) { free_[CellOf(x, y)] = 1; });
  ForEachEdge(edges, [&](int x, int y) {
    if (free_[CellOf(x, y)] == 0) return;
    Grow({x, y});
    if (moments_.n >= options_.min_pixels) Emit(parts);
  });
}

}  // namespace waymark
