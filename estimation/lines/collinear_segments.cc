#include "estimation/lines/collinear_segments.h"

#include "estimation/base/check.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

namespace waymark {
namespace {

using Eigen::Vector2d;

// A segment as its middle and half of it.
struct Piece {
  Vector2d middle;
  Vector2d half;
  double length;
  std::size_t index;
};

std::vector<Piece> LongestPieces(std::span<const LineSegment> segments,
                                 int max_lines) {
  std::vector<Piece> pieces;
  pieces.reserve(segments.size());
  for (std::size_t i = 0; i < segments.size(); ++i) {
    const LineSegment& segment = segments[i];
    WAYMARK_CHECK(segment.a.allFinite() && segment.b.allFinite());
    WAYMARK_CHECK(segment.a != segment.b);
    WAYMARK_CHECK(segment.sigma_px > 0.0, segment.sigma_px);
    WAYMARK_CHECK(segment.sigma_rad > 0.0, segment.sigma_rad);
    const Vector2d half = 0.5 * (segment.b - segment.a);
    pieces.push_back(
        {0.5 * (segment.a + segment.b), half, 2.0 * half.norm(), i});
  }
  std::stable_sort(
      pieces.begin(), pieces.end(), [](const Piece& a, const Piece& b) {
        return a.length > b.length;
      });
  if (pieces.size() > static_cast<std::size_t>(max_lines)) {
    pieces.erase(pieces.begin() + max_lines, pieces.end());
  }
  return pieces;
}

// Middles of eight pieces, which are passed over where none is near a line.
struct Block {
  static constexpr std::size_t kSize = 8;
  std::array<float, kSize> x{};
  std::array<float, kSize> y{};

  // Of the middles from the line of a piece, px.
  [[nodiscard]] float Least(const Eigen::Vector2f& normal,
                            const Eigen::Vector2f& middle) const {
    std::array<float, kSize> off;
    for (std::size_t i = 0; i < kSize; ++i) {
      off[i] = std::abs(normal.x() * (x[i] - middle.x()) +
                        normal.y() * (y[i] - middle.y()));
    }
    std::array<float, 4> least;
    for (std::size_t i = 0; i < 4; ++i) {
      least[i] = off[i] < off[i + 4] ? off[i] : off[i + 4];
    }
    return std::min(std::min(least[0], least[1]), std::min(least[2], least[3]));
  }
};

std::vector<Block> BlocksOf(const std::vector<Piece>& pieces) {
  std::vector<Block> blocks((pieces.size() + Block::kSize - 1) / Block::kSize);
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    Block& block = blocks[i / Block::kSize];
    block.x[i % Block::kSize] = static_cast<float>(pieces[i].middle.x());
    block.y[i % Block::kSize] = static_cast<float>(pieces[i].middle.y());
  }
  return blocks;
}

// The line of pieces, in a frame along their longest: distance across it is
// offset + turn * s at s from its middle.
class JointLine {
 public:
  JointLine(const Piece& first, const LineSegment& segment)
      : middle_(first.middle),
        along_(first.half / (0.5 * first.length)),
        low_(-0.5 * first.length),
        high_(0.5 * first.length) {
    Add(0.0, 0.0, 0.0, segment);
  }

  // Takes the piece, if it lies along the line and near its ends.
  bool Take(const Piece& piece,
            const LineSegment& segment,
            const CollinearOptions& options) {
    const Vector2d off = piece.middle - middle_;
    const double across = Across(off);
    if (std::abs(across) > options.max_distance_px) return false;
    const double rise = Across(piece.half);
    if (std::abs(across) + std::abs(rise) > options.max_distance_px) {
      return false;
    }
    const double s = along_.dot(off);
    const double run = along_.dot(piece.half);
    const double low = s - std::abs(run);
    const double high = s + std::abs(run);
    const double gap = std::max(low - high_, low_ - high);
    if (gap > options.max_gap * (high_ - low_)) return false;
    // Short pieces may stand across: of those the ends were close enough.
    Add(s, across, std::atan(rise / run), segment);
    low_ = std::min(low_, low);
    high_ = std::max(high_, high);
    return true;
  }

  [[nodiscard]] LineSegment Segment(const LineSegment& longest) const {
    const double det = weight_ * ss_ - s_ * s_;
    const double offset = (ss_ * d_ - s_ * sd_) / det;
    const double turn = (weight_ * sd_ - s_ * d_) / det;
    const Vector2d normal(-along_.y(), along_.x());
    const auto at = [&](double s) -> Vector2d {
      return middle_ + s * along_ + (offset + turn * s) * normal;
    };
    LineSegment joined = longest;
    joined.a = at(low_);
    joined.b = at(high_);
    // At the middle of the ends, as LineSegment has it.
    const double s = 0.5 * (low_ + high_);
    joined.sigma_px = std::sqrt((ss_ - 2.0 * s * s_ + s * s * weight_) / det);
    joined.sigma_rad = std::sqrt(weight_ / det);
    return joined;
  }

 private:
  [[nodiscard]] double Across(const Vector2d& v) const {
    return along_.x() * v.y() - along_.y() * v.x();
  }

  void Add(double s, double d, double turn, const LineSegment& segment) {
    const double weight = 1.0 / (segment.sigma_px * segment.sigma_px);
    const double weight_rad = 1.0 / (segment.sigma_rad * segment.sigma_rad);
    weight_ += weight;
    s_ += weight * s;
    ss_ += weight * s * s + weight_rad;
    d_ += weight * d;
    sd_ += weight * s * d + weight_rad * turn;
  }

  Vector2d middle_;
  Vector2d along_;
  double low_;
  double high_;
  // Normal equations of offset and turn.
  double weight_ = 0.0;
  double s_ = 0.0;
  double ss_ = 0.0;
  double d_ = 0.0;
  double sd_ = 0.0;
};

}  // namespace

void CollinearOptions::Check() const {
  if (!(max_distance_px > 0.0) || !(max_distance_px <= 10.0)) {
    throw std::invalid_argument("max_distance_px must be in (0, 10]");
  }
  if (!(max_gap >= 0.0) || !(max_gap <= 100.0)) {
    throw std::invalid_argument("max_gap must be in [0, 100]");
  }
  if (max_lines < 1) throw std::invalid_argument("max_lines: at least 1");
}

JoinedSegments JoinCollinear(std::span<const LineSegment> segments,
                             const CollinearOptions& options) {
  options.Check();
  const std::vector<Piece> pieces = LongestPieces(segments, options.max_lines);
  JoinedSegments joined;
  joined.num_pieces.assign(segments.size(), 1);
  const std::vector<Block> blocks = BlocksOf(pieces);
  // Floats are good to a hundredth of a pixel in any image.
  const auto reach = static_cast<float>(options.max_distance_px + 0.01);
  std::vector<char> is_taken(pieces.size(), 0);
  std::vector<std::size_t> taken;
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    if (is_taken[i] != 0) continue;
    const LineSegment& longest = segments[pieces[i].index];
    JointLine line(pieces[i], longest);
    taken.assign(1, pieces[i].index);
    const Vector2d half = pieces[i].half * (2.0 / pieces[i].length);
    const Eigen::Vector2f normal(static_cast<float>(-half.y()),
                                 static_cast<float>(half.x()));
    const Eigen::Vector2f middle = pieces[i].middle.cast<float>();
    for (std::size_t b = i / Block::kSize; b < blocks.size(); ++b) {
      if (blocks[b].Least(normal, middle) > reach) continue;
      const std::size_t end = std::min((b + 1) * Block::kSize, pieces.size());
      for (std::size_t j = std::max(i + 1, b * Block::kSize); j < end; ++j) {
        const Piece& piece = pieces[j];
        if (is_taken[j] != 0 ||
            !line.Take(piece, segments[piece.index], options)) {
          continue;
        }
        is_taken[j] = 1;
        taken.push_back(piece.index);
      }
    }
    for (const std::size_t index : taken) {
      joined.num_pieces[index] = static_cast<int>(taken.size());
    }
    joined.segments.push_back(taken.size() == 1 ? longest
                                                : line.Segment(longest));
  }
  std::stable_sort(joined.segments.begin(),
                   joined.segments.end(),
                   [](const auto& a, const auto& b) {
                     return (a.b - a.a).squaredNorm() >
                            (b.b - b.a).squaredNorm();
                   });
  return joined;
}

}  // namespace waymark
