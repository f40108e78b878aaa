#include "drivers/simulator/renderer.h"

#include "drivers/simulator/parallel_rows.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <stdexcept>
#include <vector>

namespace waymark {
namespace {

constexpr int kLanes = RayPacket::kLanes;
static_assert(kLanes == CameraRays::kLanes);

// What the centre of a pixel sees.
struct PixelHit {
  std::uint32_t triangle = RayPacket::kNothing;
  std::int32_t mover = RayPacket::kStatic;
  float distance = 0.0f;
  bool has_ray = false;
};

struct Offset {
  float x = 0.0f;
  float y = 0.0f;
};

// A grid turned so that edges near the horizontal and the vertical, which
// rooms are full of, cross its four samples one by one.
constexpr std::array<Offset, 4> kLiveOffsets = {
    Offset{-0.125f, -0.375f},
    Offset{0.375f, -0.125f},
    Offset{-0.375f, 0.125f},
    Offset{0.125f, 0.375f},
};
// Each of the four samples stands for a quarter of the pixel's area.
constexpr float kLiveScale = 0.5f;

// Each of the sixteen stands for a sixteenth.
constexpr float kStillScale = 0.25f;

// One in each of 16 columns and 16 rows, the same both ways from the centre.
// Of such patterns, found by search, the one whose worst direction of an edge
// is the best: the share of a pixel on one side of it is off by 0.042 (root
// mean square over where the edge lies). A grid of 4 x 4 has 0.072 for upright
// and level edges, which rooms are full of.
constexpr std::array<Offset, 16> kStillOffsets = [] {
  constexpr std::array<int, 16> kRows{
      13, 4, 9, 0, 5, 14, 8, 3, 12, 7, 1, 10, 15, 6, 11, 2};
  std::array<Offset, 16> offsets{};
  for (std::size_t i = 0; i < offsets.size(); ++i) {
    offsets[i] = {(static_cast<float>(i) + 0.5f) / 16.0f - 0.5f,
                  (static_cast<float>(kRows[i]) + 0.5f) / 16.0f - 0.5f};
  }
  return offsets;
}();

// Where colours go, and whether the hits of the centres are needed later.
struct Targets {
  cv::Mat3f* linear = nullptr;
  cv::Mat3b* image = nullptr;
  const SrgbTable* srgb = nullptr;
  bool needs_hits = false;
};

// One call of Render: shared by its threads.
class Frame {
 public:
  Frame(const RayCaster& caster,
        const SurfaceShader& shader,
        const CameraRays& camera,
        const Eigen::Isometry3d& X_WC,
        std::span<const Eigen::Isometry3d> X_WP,
        const Targets& targets)
      : caster_(caster),
        shader_(shader),
        camera_(camera),
        R_WC_(X_WC.rotation().cast<float>()),
        p_WC_(X_WC.translation()),
        placement_(caster.Place(X_WP)),
        movers_(shader.Place(X_WP, p_WC_)),
        targets_(targets) {
    if (targets.needs_hits) {
      hits_.resize(static_cast<std::size_t>(camera.size().width) *
                   static_cast<std::size_t>(camera.size().height));
    }
  }

  [[nodiscard]] const PixelHit& hit(int x, int y) const {
    return hits_[static_cast<std::size_t>(y) *
                     static_cast<std::size_t>(camera_.size().width) +
                 static_cast<std::size_t>(x)];
  }

  // Centres of two rows of pixels; their colours too if `has_colour`.
  void TraceCentres(int block_row, bool has_colour) {
    RayFan fan;
    SetOrigin(p_WC_.cast<float>(), &fan.rays);
    alignas(32) std::array<Float4, kLanes> colours;
    for (int column = 0; column < camera_.num_block_columns(); ++column) {
      const CameraRays::Block& block = camera_.block(block_row, column);
      if (block.valid == 0) continue;
      TurnToWorld(block, &fan);
      Trace(&fan);
      if (has_colour) shader_.Shade(fan, movers_, 1.0f, colours.data());
      const int x = column * CameraRays::kBlockWidth;
      const int y = block_row * CameraRays::kBlockHeight;
      for (std::uint32_t left = block.valid; left != 0; left &= left - 1u) {
        const int lane = std::countr_zero(left);
        const int dx = lane % CameraRays::kBlockWidth;
        const int dy = lane / CameraRays::kBlockWidth;
        if (targets_.needs_hits) StoreHit(x + dx, y + dy, fan.rays, lane);
        if (has_colour) {
          StoreColour(x + dx, y + dy, colours[static_cast<std::size_t>(lane)]);
        }
      }
    }
  }

  // Mean of samples at `offsets` from the centres of the pixels of a row for
  // which `is_wanted`.
  template <std::size_t kNum, typename Wanted>
  void Supersample(int y,
                   const std::array<Offset, kNum>& offsets,
                   float footprint_scale,
                   const Wanted& is_wanted) const {
    // A packet holds samples of several pixels, or a pixel has several packets.
    constexpr auto kPixels =
        static_cast<int>(kNum < kLanes ? kLanes / kNum : 1);
    std::array<int, kPixels> columns{};
    int num_columns = 0;
    for (int x = 0; x < camera_.size().width; ++x) {
      if (hit(x, y).has_ray && is_wanted(x, y)) columns[num_columns++] = x;
      if (num_columns == kPixels ||
          (x + 1 == camera_.size().width && num_columns > 0)) {
        SamplePixels(std::span(columns.data(), num_columns),
                     y,
                     std::span(offsets),
                     footprint_scale);
        num_columns = 0;
      }
    }
  }

  // Whether a pixel and one of its four neighbours see different surfaces.
  [[nodiscard]] bool IsEdge(int x, int y) const {
    const PixelHit& here = hit(x, y);
    const auto differs = [&](int other_x, int other_y) {
      if (other_x < 0 || other_y < 0 || other_x >= camera_.size().width ||
          other_y >= camera_.size().height) {
        return false;
      }
      const PixelHit& other = hit(other_x, other_y);
      if (other.triangle == here.triangle && other.mover == here.mover) {
        return false;
      }
      return other.has_ray && !AreOneSurface(here, x, y, other);
    };
    return differs(x - 1, y) || differs(x + 1, y) || differs(x, y - 1) ||
           differs(x, y + 1);
  }

 private:
  void TurnToWorld(const CameraRays::Block& block, RayFan* fan) const {
    Turn(block.direction, fan->rays.direction);
    Turn(block.d_x, fan->d_x);
    Turn(block.d_y, fan->d_y);
    fan->rays.active = block.valid;
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

  void Trace(RayFan* fan) const {
    caster_.Trace(&fan->rays, &placement_);
    shader_.RefineDistances(p_WC_, &fan->rays);
  }

  void StoreHit(int x, int y, const RayPacket& rays, int lane) {
    const bool is_met = rays.triangle[lane] != RayPacket::kNothing;
    hits_[static_cast<std::size_t>(y) *
              static_cast<std::size_t>(camera_.size().width) +
          static_cast<std::size_t>(x)] = {rays.triangle[lane],
                                          rays.mover[lane],
                                          is_met ? rays.distance[lane] : 0.0f,
                                          true};
  }

  void StoreColour(int x, int y, const Float4& colour) const {
    if (targets_.linear != nullptr) {
      cv::Vec3f& pixel = targets_.linear->ptr<cv::Vec3f>(y)[x];
      for (int c = 0; c < 3; ++c) pixel[c] = colour[c];
    }
    if (targets_.image != nullptr) {
      cv::Vec3b& pixel = targets_.image->ptr<cv::Vec3b>(y)[x];
      for (int c = 0; c < 3; ++c)
        pixel[c] = targets_.srgb->FromLinear(colour[c]);
    }
  }

  // Lane `lane` of `fan` becomes the ray of a pixel, `offset` from its centre.
  void SetSample(
      int x, int y, const Offset& offset, int lane, RayFan* fan) const {
    const CameraRays::Block& block = camera_.block(y / CameraRays::kBlockHeight,
                                                   x / CameraRays::kBlockWidth);
    const int from = y % CameraRays::kBlockHeight * CameraRays::kBlockWidth +
                     x % CameraRays::kBlockWidth;
    Eigen::Vector3f direction;
    Eigen::Vector3f d_x;
    Eigen::Vector3f d_y;
    for (int i = 0; i < 3; ++i) {
      d_x[i] = block.d_x[i][from];
      d_y[i] = block.d_y[i][from];
      direction[i] =
          block.direction[i][from] + offset.x * d_x[i] + offset.y * d_y[i];
    }
    direction = R_WC_ * direction;
    d_x = R_WC_ * d_x;
    d_y = R_WC_ * d_y;
    for (int i = 0; i < 3; ++i) {
      fan->rays.direction[i][lane] = direction[i];
      fan->d_x[i][lane] = d_x[i];
      fan->d_y[i][lane] = d_y[i];
    }
    fan->rays.active |= 1u << lane;
  }

  void SamplePixels(std::span<const int> columns,
                    int y,
                    std::span<const Offset> offsets,
                    float footprint_scale) const {
    const auto num_offsets = static_cast<int>(offsets.size());
    const auto num_samples = static_cast<int>(columns.size()) * num_offsets;
    std::array<Float4, 2> sums{};  // As many pixels as fit into a packet.
    for (int first = 0; first < num_samples; first += kLanes) {
      RayFan fan;
      SetOrigin(p_WC_.cast<float>(), &fan.rays);
      fan.rays.active = 0;
      const int num_lanes = std::min(kLanes, num_samples - first);
      for (int lane = 0; lane < kLanes; ++lane) {
        // Lanes without a sample repeat the first one's ray, unused.
        const int sample = first + (lane < num_lanes ? lane : 0);
        SetSample(columns[static_cast<std::size_t>(sample / num_offsets)],
                  y,
                  offsets[static_cast<std::size_t>(sample % num_offsets)],
                  lane,
                  &fan);
      }
      fan.rays.active = (1u << num_lanes) - 1u;
      Trace(&fan);
      alignas(32) std::array<Float4, kLanes> colours;
      shader_.Shade(fan, movers_, footprint_scale, colours.data());
      for (int lane = 0; lane < num_lanes; ++lane) {
        sums[static_cast<std::size_t>((first + lane) / num_offsets)] +=
            colours[static_cast<std::size_t>(lane)];
      }
    }
    const float share = 1.0f / static_cast<float>(num_offsets);
    for (std::size_t i = 0; i < columns.size(); ++i) {
      StoreColour(columns[i], y, Broadcast(share) * sums[i]);
    }
  }

  // Of two pixels with different triangles: whether they go on from each
  // other smoothly.
  [[nodiscard]] bool AreOneSurface(const PixelHit& a,
                                   int /*x*/,
                                   int /*y*/,
                                   const PixelHit& b) const {
    if (a.mover != b.mover || a.triangle == RayPacket::kNothing ||
        b.triangle == RayPacket::kNothing) {
      return false;
    }
    const ShadedTriangle& s = shader_.triangle(a.mover, a.triangle);
    const ShadedTriangle& t = shader_.triangle(b.mover, b.triangle);
    if (s.material != t.material || s.surface != t.surface) return false;
    const Eigen::Map<const Eigen::Vector3d> normal_s(s.normal);
    const Eigen::Map<const Eigen::Vector3d> normal_t(t.normal);
    // A turn by 18 degrees changes the light by less than edges show.
    constexpr double kSmooth = 0.95;
    if (std::abs(normal_s.dot(normal_t)) < kSmooth) return false;
    // Neighbouring pixels of a smooth surface lie about equally far; at flat
    // angles they may not, and are sampled more finely for nothing.
    constexpr float kJump = 0.05f;
    return std::abs(a.distance - b.distance) <
           kJump * std::min(a.distance, b.distance);
  }

  const RayCaster& caster_;
  const SurfaceShader& shader_;
  const CameraRays& camera_;
  Eigen::Matrix3f R_WC_;
  Eigen::Vector3d p_WC_;
  RayCaster::Placement placement_;
  std::vector<PlacedMover> movers_;
  Targets targets_;
  std::vector<PixelHit> hits_;
};

const RendererOptions& Checked(const RendererOptions& options) {
  options.Check();
  return options;
}

void StoreGeometryRow(const Frame& frame,
                      const SurfaceShader& shader,
                      int y,
                      RenderedView* view) {
  const int width =
      std::max({view->depth.cols, view->surface.cols, view->floor.cols});
  float* depth = view->depth.empty() ? nullptr : view->depth[y];
  int* surfaces = view->surface.empty() ? nullptr : view->surface[y];
  std::uint8_t* floor = view->floor.empty() ? nullptr : view->floor[y];
  for (int x = 0; x < width; ++x) {
    const PixelHit& hit = frame.hit(x, y);
    if (depth != nullptr) depth[x] = hit.distance;
    if (surfaces == nullptr && floor == nullptr) continue;
    if (hit.triangle == RayPacket::kNothing) continue;
    const std::uint32_t surface =
        shader.triangle(hit.mover, hit.triangle).surface;
    if (surfaces != nullptr) surfaces[x] = static_cast<int>(surface);
    if (floor != nullptr &&
        shader.surfaces()[surface].kind == SurfaceKind::kFloor) {
      floor[x] = 255;
    }
  }
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
      shader_(scene, options.shader, options.num_threads) {}

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
  const bool has_geometry = options.depth || options.surface || options.floor;
  const bool is_still = options.quality == RenderQuality::kStill;
  const bool is_live = options.quality == RenderQuality::kLive;
  Frame frame(caster_,
              shader_,
              camera,
              X_WC,
              X_WP,
              {options.linear ? &view.linear : nullptr,
               options.image ? &view.image : nullptr,
               &srgb_,
               has_geometry || is_still || is_live});
  ForEachRow(camera.num_block_rows(), options_.num_threads, [&](int row) {
    frame.TraceCentres(row, has_colour && !is_still);
  });
  ForEachRow(size.height, options_.num_threads, [&](int y) {
    if (has_geometry) StoreGeometryRow(frame, shader_, y, &view);
    if (has_colour && is_still) {
      const auto all = [](int, int) { return true; };
      frame.Supersample(y, kStillOffsets, kStillScale, all);
    } else if (has_colour && is_live) {
      const auto edges = [&](int x, int row) { return frame.IsEdge(x, row); };
      frame.Supersample(y, kLiveOffsets, kLiveScale, edges);
    }
  });
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
