#include "drivers/simulator/renderer.h"

#include "drivers/simulator/parallel_rows.h"
#include "drivers/simulator/render_frame.h"

#include <stdexcept>

namespace waymark {
namespace {

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
  RenderFrame frame(
      caster_, shader_, srgb_, camera, X_WC, X_WP, mover_tiles_, &view);
  if (has_edges) frame.KeepHits();
  ForEachRow(camera.num_block_rows(), options_.num_threads, [&](int row) {
    frame.TraceCentres(row, has_colour && !is_still);
  });
  if (has_colour && (is_still || has_edges)) {
    ForEachRow(size.height, options_.num_threads, [&](int y) {
      if (is_still) {
        frame.SupersampleRow(y);
      } else {
        frame.SupersampleEdges(y);
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
