#include "drivers/simulator/render_frame.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>

namespace waymark {
namespace {

int LaneOf(int x, int y) {
  return y % CameraRays::kBlockHeight * CameraRays::kBlockWidth +
         x % CameraRays::kBlockWidth;
}

// Calls visit(lane, x, y) for the pixels of a block that have a ray.
template <typename Visit>
void ForEachPixel(int x, int y, std::uint32_t lanes, const Visit& visit) {
  for (; lanes != 0; lanes &= lanes - 1u) {
    const int lane = std::countr_zero(lanes);
    visit(lane,
          x + lane % CameraRays::kBlockWidth,
          y + lane / CameraRays::kBlockWidth);
  }
}

// Of four lanes.
Float4 Sum(const Colours& colours, int half) {
  Float4 sum{};
  for (int c = 0; c < 3; ++c) {
    const float* four = colours.bgr[c] + 4 * half;
    sum[c] = (four[0] + four[1]) + (four[2] + four[3]);
  }
  return sum;
}

}  // namespace

RenderFrame::RenderFrame(const RayCaster& caster,
                         const SurfaceShader& shader,
                         const SrgbTable& srgb,
                         const CameraRays& camera,
                         const Eigen::Isometry3d& X_WC,
                         std::span<const Eigen::Isometry3d> X_WP,
                         const MoverTiles& mover_tiles,
                         RenderedView* out)
    : caster_(caster),
      shader_(shader),
      srgb_(srgb),
      camera_(camera),
      width_(camera.size().width),
      height_(camera.size().height),
      R_WC_(X_WC.linear().cast<float>()),
      p_WC_(X_WC.translation()),
      placement_(caster.Place(X_WP)),
      view_(shader.Place(X_WP, X_WC)),
      has_movers_(mover_tiles.Near(camera, X_WC, X_WP)),
      out_(*out) {}

void RenderFrame::KeepHits() {
  stride_ = static_cast<std::size_t>(camera_.num_block_columns()) *
            CameraRays::kBlockWidth;
  const std::size_t num = stride_ * CameraRays::kBlockHeight *
                          static_cast<std::size_t>(camera_.num_block_rows());
  ids_.assign(num, kNoRay);
  distances_.resize(num);
}

void RenderFrame::TraceCentres(int block_row, bool has_colour) {
  // Several packets at each step, so that the processor's pipelines stay
  // full: a step's work on one does not wait for that on the one before.
  constexpr int kBatch = 8;
  std::array<RayPacket, kBatch> batch;
  for (RayPacket& rays : batch) SetOrigin(p_WC_.cast<float>(), &rays);
  TrianglesInView triangles(view_);
  const int num_columns = camera_.num_block_columns();
  const int y = block_row * CameraRays::kBlockHeight;
  for (int first = 0; first < num_columns; first += kBatch) {
    const int num = std::min(kBatch, num_columns - first);
    for (int i = 0; i < num; ++i) {
      RayPacket& rays = batch[static_cast<std::size_t>(i)];
      const int x = (first + i) * CameraRays::kBlockWidth;
      Trace(camera_.block(block_row, first + i), x, y, &rays);
      Store(x, y, &rays);
    }
    for (int i = 0; i < num && has_colour; ++i) {
      const CameraRays::Block& block = camera_.block(block_row, first + i);
      if (block.valid == 0) continue;
      Colours colours;
      shader_.Shade(batch[static_cast<std::size_t>(i)],
                    block,
                    1.0f,
                    &triangles,
                    &colours);
      StoreColours(
          (first + i) * CameraRays::kBlockWidth, y, block.valid, colours);
    }
  }
}

void RenderFrame::SupersampleRow(int y) const {
  constexpr std::size_t kNum = kStillPattern.x.size();
  static_assert(kNum % kLanes == 0);
  TrianglesInView triangles(view_);
  for (int x = 0; x < width_; ++x) {
    if ((BlockOf(x, y).valid >> LaneOf(x, y) & 1u) == 0) continue;
    Float4 sum{};
    for (std::size_t g = 0; g < kStillPattern.kGroups; g += 2) {
      Samples samples;
      SetSamples(x, y, kStillPattern, g, 0, &samples);
      SetSamples(x, y, kStillPattern, g + 1, 1, &samples);
      const Colours colours = Sample(HasMovers(x, y),
                                     RayPacket::kAllLanes,
                                     kStillPattern.footprint_scale,
                                     &samples,
                                     &triangles);
      sum += Sum(colours, 0) + Sum(colours, 1);
    }
    StoreMean(x, y, kNum, sum);
  }
}

void RenderFrame::SupersampleEdges(int y) const {
  TrianglesInView triangles(view_);
  Samples samples;
  int first = -1;  // Pixel that waits for a second one.
  const auto finish = [&](int second) {
    const std::uint32_t lanes = second < 0 ? 0xFu : RayPacket::kAllLanes;
    const int last = second < 0 ? first : second;
    SetSamples(first, y, kLivePattern, 0, 0, &samples);
    SetSamples(last, y, kLivePattern, 0, 1, &samples);
    const bool has_movers = HasMovers(first, y) || HasMovers(last, y);
    const Colours colours = Sample(
        has_movers, lanes, kLivePattern.footprint_scale, &samples, &triangles);
    StoreMean(first, y, 4, Sum(colours, 0));
    if (second >= 0) StoreMean(second, y, 4, Sum(colours, 1));
  };
  for (int x = 0; x < width_; ++x) {
    if (!IsEdge(x, y)) continue;
    if (first < 0) {
      first = x;
    } else {
      finish(x);
      first = -1;
    }
  }
  if (first >= 0) finish(-1);
}

inline void RenderFrame::Turn(const float (&from)[3][kLanes],
                              float (&to)[3][kLanes]) const {
  constexpr int kStep = 4;
  for (int lane = 0; lane < kLanes; lane += kStep) {
    const Float4 x = LoadFour(from[0] + lane);
    const Float4 y = LoadFour(from[1] + lane);
    const Float4 z = LoadFour(from[2] + lane);
    for (int i = 0; i < 3; ++i) {
      StoreFour(Broadcast(R_WC_(i, 0)) * x + Broadcast(R_WC_(i, 1)) * y +
                    Broadcast(R_WC_(i, 2)) * z,
                to[i] + lane);
    }
  }
}

inline void RenderFrame::Trace(const CameraRays::Block& block,
                               int x,
                               int y,
                               RayPacket* rays) const {
  rays->active = block.valid;
  if (block.valid == 0) return;
  Turn(block.direction, rays->direction);
  caster_.Trace(rays, HasMovers(x, y) ? &placement_ : nullptr);
}

inline std::uint32_t RenderFrame::IdOf(const RayPacket& rays, int lane) const {
  return rays.triangle[lane] == kNothing
             ? kNothing
             : shader_.TriangleId(rays.mover[lane], rays.triangle[lane]);
}

inline void RenderFrame::Store(int x, int y, RayPacket* rays) {
  if (!ids_.empty()) StoreHits(x, y, *rays);
  if (!out_.depth.empty()) StoreDepth(x, y, rays);
  if (!out_.surface.empty() || !out_.floor.empty()) StoreSurface(x, y, *rays);
}

inline void RenderFrame::StoreHits(int x, int y, const RayPacket& rays) {
  ForEachPixel(x, y, rays.active, [&](int lane, int at_x, int at_y) {
    ids_[HitIndex(at_x, at_y)] = IdOf(rays, lane);
    distances_[HitIndex(at_x, at_y)] = rays.distance[lane];
  });
}

inline void RenderFrame::StoreDepth(int x, int y, RayPacket* rays) const {
  shader_.RefineDistances(p_WC_, rays);
  ForEachPixel(x, y, rays->active, [&](int lane, int at_x, int at_y) {
    const bool is_met = rays->triangle[lane] != kNothing;
    out_.depth.ptr<float>(at_y)[at_x] = is_met ? rays->distance[lane] : 0.0f;
  });
}

inline void RenderFrame::StoreSurface(int x,
                                      int y,
                                      const RayPacket& rays) const {
  ForEachPixel(x, y, rays.active, [&](int lane, int at_x, int at_y) {
    const std::uint32_t id = IdOf(rays, lane);
    if (id == kNothing) return;
    const std::uint32_t surface = shader_.triangle(id).surface;
    if (!out_.surface.empty()) {
      out_.surface.ptr<int>(at_y)[at_x] = static_cast<int>(surface);
    }
    if (!out_.floor.empty() &&
        shader_.surfaces()[surface].kind == SurfaceKind::kFloor) {
      out_.floor.ptr<std::uint8_t>(at_y)[at_x] = 255;
    }
  });
}

inline void RenderFrame::StoreColours(int x,
                                      int y,
                                      std::uint32_t lanes,
                                      const Colours& colours) const {
  if (!out_.linear.empty()) {
    ForEachPixel(x, y, lanes, [&](int lane, int at_x, int at_y) {
      cv::Vec3f& pixel = out_.linear.ptr<cv::Vec3f>(at_y)[at_x];
      for (int c = 0; c < 3; ++c) pixel[c] = colours.bgr[c][lane];
    });
  }
  if (out_.image.empty()) return;
  alignas(16) std::int32_t places[3][kLanes];
  for (int c = 0; c < 3; ++c) {
    for (int lane = 0; lane < kLanes; lane += 4) {
      const Int4 four = SrgbTable::PlacesOf(LoadFour(colours.bgr[c] + lane));
      std::memcpy(places[c] + lane, &four, sizeof four);
    }
  }
  const auto store = [&](int lane, std::uint8_t* pixel) {
    pixel[0] = srgb_.Value(places[0][lane]);
    pixel[1] = srgb_.Value(places[1][lane]);
    pixel[2] = srgb_.Value(places[2][lane]);
  };
  if (lanes == RayPacket::kAllLanes) {
    std::uint8_t* upper = out_.image.ptr<std::uint8_t>(y) + 3 * x;
    std::uint8_t* lower = out_.image.ptr<std::uint8_t>(y + 1) + 3 * x;
    for (int i = 0; i < CameraRays::kBlockWidth; ++i) {
      store(i, upper + 3 * i);
      store(i + CameraRays::kBlockWidth, lower + 3 * i);
    }
    return;
  }
  ForEachPixel(x, y, lanes, [&](int lane, int at_x, int at_y) {
    store(lane, out_.image.ptr<std::uint8_t>(at_y) + 3 * at_x);
  });
}

inline void RenderFrame::StoreMean(int x,
                                   int y,
                                   int num,
                                   const Float4& sum) const {
  const Float4 colour = Broadcast(1.0f / static_cast<float>(num)) * sum;
  if (!out_.linear.empty()) {
    cv::Vec3f& pixel = out_.linear.ptr<cv::Vec3f>(y)[x];
    for (int c = 0; c < 3; ++c) pixel[c] = colour[c];
  }
  if (!out_.image.empty()) {
    cv::Vec3b& pixel = out_.image.ptr<cv::Vec3b>(y)[x];
    for (int c = 0; c < 3; ++c) pixel[c] = srgb_.FromLinear(colour[c]);
  }
}

template <std::size_t kNum>
inline void RenderFrame::SetSamples(int x,
                                    int y,
                                    const SamplePattern<kNum>& pattern,
                                    std::size_t group,
                                    int half,
                                    Samples* samples) const {
  const CameraRays::Block& from = BlockOf(x, y);
  const int lane = LaneOf(x, y);
  const Float4 right = LoadFour(pattern.x.data() + 4 * group);
  const Float4 down = LoadFour(pattern.y.data() + 4 * group);
  CameraRays::Block& to = samples->rays_C;
  for (int i = 0; i < 3; ++i) {
    const Float4 d_x = Broadcast(from.d_x[i][lane]);
    const Float4 d_y = Broadcast(from.d_y[i][lane]);
    StoreFour(Broadcast(from.direction[i][lane]) + right * d_x + down * d_y,
              to.direction[i] + 4 * half);
    StoreFour(d_x, to.d_x[i] + 4 * half);
    StoreFour(d_y, to.d_y[i] + 4 * half);
  }
}

inline Colours RenderFrame::Sample(bool has_movers,
                                   std::uint32_t lanes,
                                   float footprint_scale,
                                   Samples* samples,
                                   TrianglesInView* triangles) const {
  RayPacket& rays = samples->rays;
  SetOrigin(p_WC_.cast<float>(), &rays);
  Turn(samples->rays_C.direction, rays.direction);
  rays.active = lanes;
  caster_.Trace(&rays, has_movers ? &placement_ : nullptr);
  Colours colours;
  shader_.Shade(rays, samples->rays_C, footprint_scale, triangles, &colours);
  return colours;
}

inline bool RenderFrame::IsEdge(int x, int y) const {
  const std::size_t here = HitIndex(x, y);
  const std::uint32_t id = ids_[here];
  const auto differs = [&](std::size_t other) {
    return ids_[other] != id && ids_[other] != kNoRay &&
           !AreOneSurface(here, other);
  };
  return id != kNoRay && ((x > 0 && differs(here - 1)) ||
                          (x + 1 < width_ && differs(here + 1)) ||
                          (y > 0 && differs(here - stride_)) ||
                          (y + 1 < height_ && differs(here + stride_)));
}

inline bool RenderFrame::AreOneSurface(std::size_t a, std::size_t b) const {
  if (ids_[a] == kNothing || ids_[b] == kNothing) return false;
  const ShadedTriangle& s = shader_.triangle(ids_[a]);
  const ShadedTriangle& t = shader_.triangle(ids_[b]);
  if (s.mover != t.mover || s.material != t.material ||
      s.surface != t.surface) {
    return false;
  }
  const Eigen::Map<const Eigen::Vector3d> normal_s(s.normal);
  const Eigen::Map<const Eigen::Vector3d> normal_t(t.normal);
  // A turn by 18 degrees changes the light by less than edges show.
  constexpr double kSmooth = 0.95;
  if (std::abs(normal_s.dot(normal_t)) < kSmooth) return false;
  // Neighbouring pixels of a smooth surface lie about equally far; at flat
  // angles they may not, and are sampled more finely for nothing.
  constexpr float kJump = 0.05f;
  return std::abs(distances_[a] - distances_[b]) <
         kJump * std::min(distances_[a], distances_[b]);
}

}  // namespace waymark
