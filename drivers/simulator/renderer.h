// Images of a scene, with the depth and the surface of every pixel.
#pragma once

#include "drivers/simulator/camera_rays.h"
#include "drivers/simulator/mover_tiles.h"
#include "drivers/simulator/ray_caster.h"
#include "drivers/simulator/scene.h"
#include "drivers/simulator/srgb.h"
#include "drivers/simulator/surface_shader.h"

#include <Eigen/Geometry>
#include <opencv2/core/mat.hpp>

#include <cstddef>
#include <span>

namespace waymark {

struct RendererOptions {
  int num_threads = 1;  // At least 1. The result does not depend on it.
  SurfaceShaderOptions shader;

  // Throws std::invalid_argument naming the first field out of range.
  void Check() const;
};

enum class RenderQuality {
  // One sample a pixel, textures filtered: edges are stepped.
  kSingle,
  // As kSingle, and four samples for the pixels at an edge of a surface.
  kLive,
  // Sixteen samples a pixel.
  kStill,
};

struct RenderOptions {
  RenderQuality quality = RenderQuality::kLive;
  // What is wanted; the rest of the view stays empty.
  bool image = true;
  bool linear = false;
  bool depth = false;
  bool surface = false;
  bool floor = false;
};

// Of the size of the camera's images. Depth, surface and floor are those at
// the pixel's centre.
struct RenderedView {
  cv::Mat3b image;    // BGR, sRGB curve.
  cv::Mat3f linear;   // BGR, linear light, not clipped.
  cv::Mat1f depth;    // Along the ray, m; 0 where nothing is met.
  cv::Mat1i surface;  // Index of Scene::surfaces; -1 where nothing is met.
  cv::Mat1b floor;    // 255 on surfaces of kind kFloor, 0 elsewhere.
};

// Pixels outside the camera model's domain and rays that meet nothing are
// black, without depth and surface. Same scene and arguments: same bytes.
class Renderer {
 public:
  // Copies the scene and computes its light, which takes seconds for a
  // building. Throws std::invalid_argument for a scene that CheckScene
  // refuses.
  explicit Renderer(const Scene& scene, const RendererOptions& options = {});

  // X_WP: of each mover, in the scene's order. May be called from many
  // threads.
  [[nodiscard]] RenderedView Render(const CameraRays& camera,
                                    const Eigen::Isometry3d& X_WC,
                                    std::span<const Eigen::Isometry3d> X_WP,
                                    const RenderOptions& options = {}) const;

  // For a single picture: makes the camera's rays, which costs more than the
  // picture does.
  [[nodiscard]] RenderedView Render(const CameraView& view,
                                    const Eigen::Isometry3d& X_WC,
                                    std::span<const Eigen::Isometry3d> X_WP,
                                    const RenderOptions& options = {}) const;

  [[nodiscard]] const RayCaster& caster() const { return caster_; }
  // Hierarchies, triangles, textures, light.
  [[nodiscard]] std::size_t num_bytes() const;

 private:
  RendererOptions options_;
  RayCaster caster_;
  SurfaceShader shader_;
  MoverTiles mover_tiles_;
  SrgbTable srgb_;
};

}  // namespace waymark
