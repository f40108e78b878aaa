#include "drivers/simulator/renderer.h"

#include "drivers/simulator/parallel_rows.h"
#include "drivers/simulator/sample_pattern.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <stdexcept>
#include <vector>

namespace waymark {
namespace {

constexpr int kLanes = RayPacket::kLanes;
static_assert(kLanes == CameraRays::kLanes);

// One call of Render: shared by its threads.
class Frame {
 public:
  Frame(const RayCaster& caster,
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

  // Before TraceCentres: Supersample will ask for edges.
  void KeepHits() {
    stride_ = static_cast<std::size_t>(camera_.num_block_columns()) *
              CameraRays::kBlockWidth;
    const std::size_t num = stride_ * CameraRays::kBlockHeight *
                            static_cast<std::size_t>(camera_.num_block_rows());
    ids_.assign(num, kNoRay);
    distances_.resize(num);
  }

  // Centres of two rows of pixels: what was asked for of their geometry; their
  // colours too if `has_colour`.
  void TraceCentres(int block_row, bool has_colour) {
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

  // Mean of the samples of each pixel of a row that has a ray.
  template <std::size_t kNum>
  void SupersampleRow(int y, const SamplePattern<kNum>& pattern) const {
    static_assert(kNum % kLanes == 0);
    TrianglesInView triangles(view_);
    for (int x = 0; x < width_; ++x) {
      if ((BlockOf(x, y).valid >> LaneOf(x, y) & 1u) == 0) continue;
      Float4 sum{};
      for (std::size_t g = 0; g < pattern.kGroups; g += 2) {
        Samples samples;
        SetSamples(x, y, pattern, g, 0, &samples);
        SetSamples(x, y, pattern, g + 1, 1, &samples);
        const Colours colours = Sample(HasMovers(x, y),
                                       RayPacket::kAllLanes,
                                       pattern.footprint_scale,
                                       &samples,
                                       &triangles);
        sum += Sum(colours, 0) + Sum(colours, 1);
      }
      StoreMean(x, y, kNum, sum);
    }
  }

  // The same of those pixels of a row at an edge; two at a time.
  void SupersampleEdges(int y, const SamplePattern<4>& pattern) const {
    TrianglesInView triangles(view_);
    Samples samples;
    int first = -1;  // Pixel that waits for a second one.
    const auto finish = [&](int second) {
      const std::uint32_t lanes = second < 0 ? 0xFu : RayPacket::kAllLanes;
      const int last = second < 0 ? first : second;
      SetSamples(first, y, pattern, 0, 0, &samples);
      SetSamples(last, y, pattern, 0, 1, &samples);
      const bool has_movers = HasMovers(first, y) || HasMovers(last, y);
      const Colours colours = Sample(
          has_movers, lanes, pattern.footprint_scale, &samples, &triangles);
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

 private:
  // Of pixels outside the camera's domain; where nothing is met.
  static constexpr std::uint32_t kNoRay = 0xFFFFFFFE;
  static constexpr std::uint32_t kNothing = RayPacket::kNothing;

  // Eight rays that are not those of a block of pixels.
  struct Samples {
    RayPacket rays;
    CameraRays::Block rays_C;
  };

  [[nodiscard]] const CameraRays::Block& BlockOf(int x, int y) const {
    return camera_.block(y / CameraRays::kBlockHeight,
                         x / CameraRays::kBlockWidth);
  }
  [[nodiscard]] static int LaneOf(int x, int y) {
    return y % CameraRays::kBlockHeight * CameraRays::kBlockWidth +
           x % CameraRays::kBlockWidth;
  }
  [[nodiscard]] bool HasMovers(int x, int y) const {
    return has_movers_[camera_.TileOf(x, y)] != 0;
  }
  [[nodiscard]] std::size_t HitIndex(int x, int y) const {
    return static_cast<std::size_t>(y) * stride_ + static_cast<std::size_t>(x);
  }

  // R_WC times eight vectors.
  void Turn(const float (&from)[3][kLanes], float (&to)[3][kLanes]) const {
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

  void Trace(const CameraRays::Block& block,
             int x,
             int y,
             RayPacket* rays) const {
    rays->active = block.valid;
    if (block.valid == 0) return;
    Turn(block.direction, rays->direction);
    caster_.Trace(rays, HasMovers(x, y) ? &placement_ : nullptr);
  }

  // Calls visit(lane, x, y) for the pixels of a block that have a ray.
  template <typename Visit>
  static void ForEachPixel(int x,
                           int y,
                           std::uint32_t lanes,
                           const Visit& visit) {
    for (; lanes != 0; lanes &= lanes - 1u) {
      const int lane = std::countr_zero(lanes);
      visit(lane,
            x + lane % CameraRays::kBlockWidth,
            y + lane / CameraRays::kBlockWidth);
    }
  }

  [[nodiscard]] std::uint32_t IdOf(const RayPacket& rays, int lane) const {
    return rays.triangle[lane] == kNothing
               ? kNothing
               : shader_.TriangleId(rays.mover[lane], rays.triangle[lane]);
  }

  // What was asked for of the geometry.
  void Store(int x, int y, RayPacket* rays) {
    if (!ids_.empty()) StoreHits(x, y, *rays);
    if (!out_.depth.empty()) StoreDepth(x, y, rays);
    if (!out_.surface.empty() || !out_.floor.empty()) StoreSurface(x, y, *rays);
  }

  void StoreHits(int x, int y, const RayPacket& rays) {
    ForEachPixel(x, y, rays.active, [&](int lane, int at_x, int at_y) {
      ids_[HitIndex(at_x, at_y)] = IdOf(rays, lane);
      distances_[HitIndex(at_x, at_y)] = rays.distance[lane];
    });
  }

  void StoreDepth(int x, int y, RayPacket* rays) const {
    shader_.RefineDistances(p_WC_, rays);
    ForEachPixel(x, y, rays->active, [&](int lane, int at_x, int at_y) {
      const bool is_met = rays->triangle[lane] != kNothing;
      out_.depth.ptr<float>(at_y)[at_x] = is_met ? rays->distance[lane] : 0.0f;
    });
  }

  void StoreSurface(int x, int y, const RayPacket& rays) const {
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

  void StoreColours(int x,
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

  void StoreMean(int x, int y, int num, const Float4& sum) const {
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

  // Four samples of a pixel become one half of eight.
  template <std::size_t kNum>
  void SetSamples(int x,
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

  [[nodiscard]] Colours Sample(bool has_movers,
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

  // Of four lanes.
  [[nodiscard]] static Float4 Sum(const Colours& colours, int half) {
    Float4 sum{};
    for (int c = 0; c < 3; ++c) {
      const float* four = colours.bgr[c] + 4 * half;
      sum[c] = (four[0] + four[1]) + (four[2] + four[3]);
    }
    return sum;
  }

  // Whether a pixel and one of its four neighbours see different surfaces.
  [[nodiscard]] bool IsEdge(int x, int y) const {
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

  // Of two pixels with different triangles: whether they go on from each
  // other smoothly.
  [[nodiscard]] bool AreOneSurface(std::size_t a, std::size_t b) const {
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

  const RayCaster& caster_;
  const SurfaceShader& shader_;
  const SrgbTable& srgb_;
  const CameraRays& camera_;
  int width_;
  int height_;
  Eigen::Matrix3f R_WC_;
  Eigen::Vector3d p_WC_;
  RayCaster::Placement placement_;
  ShaderView view_;
  std::vector<std::uint8_t> has_movers_;  // By tile of the camera.
  RenderedView& out_;
  // What the centres of pixels see, in rows of `stride_`.
  std::size_t stride_ = 0;
  std::vector<std::uint32_t> ids_;  // Of triangles.
  std::vector<float> distances_;
};

const RendererOptions& Checked(const RendererOptions& options) {
  options.Check();
  return options;
}

}  // namespace

void RendererOptions::Check() const {
  if (num_threads < 1) {
    throw std::invalid_argument("renderer: num_threads must be at least 1");
  }
  shader.light.Check();
  shader.light_map.Check();
}

Renderer::Renderer(const Scene& scene, const RendererOptions& options)
    : options_(Checked(options)),
      caster_(scene),
      shader_(scene, options.shader, options.num_threads),
      mover_tiles_(scene) {}

RenderedView Renderer::Render(const CameraRays& camera,
                              const Eigen::Isometry3d& X_WC,
                              std::span<const Eigen::Isometry3d> X_WP,
                              const RenderOptions& options) const {
  const cv::Size size(camera.size().width, camera.size().height);
  RenderedView view;
  if (options.depth) view.depth = cv::Mat1f::zeros(size);
  if (options.surface) view.surface = cv::Mat1i(size, -1);
  if (options.floor) view.floor = cv::Mat1b::zeros(size);
  if (options.image) view.image = cv::Mat3b::zeros(size);
  if (options.linear) view.linear = cv::Mat3f::zeros(size);
  const bool has_colour = options.image || options.linear;
  const bool is_still = options.quality == RenderQuality::kStill;
  const bool has_edges = options.quality == RenderQuality::kLive && has_colour;
  Frame frame(caster_, shader_, srgb_, camera, X_WC, X_WP, mover_tiles_, &view);
  if (has_edges) frame.KeepHits();
  ForEachRow(camera.num_block_rows(), options_.num_threads, [&](int row) {
    frame.TraceCentres(row, has_colour && !is_still);
  });
  if (has_colour && (is_still || has_edges)) {
    ForEachRow(size.height, options_.num_threads, [&](int y) {
      if (is_still) {
        frame.SupersampleRow(y, kStillPattern);
      } else {
        frame.SupersampleEdges(y, kLivePattern);
      }
    });
  }
  return view;
}

RenderedView Renderer::Render(const CameraView& view,
                              const Eigen::Isometry3d& X_WC,
                              std::span<const Eigen::Isometry3d> X_WP,
                              const RenderOptions& options) const {
  return Render(CameraRays(view), X_WC, X_WP, options);
}

std::size_t Renderer::num_bytes() const {
  return caster_.num_bytes() + shader_.num_bytes();
}

}  // namespace waymark
