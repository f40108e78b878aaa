// The simulator's pictures: rays and frames per second, and how good they are.

#include "drivers/simulator/material_pattern.h"
#include "drivers/simulator/renderer.h"
#include "drivers/simulator/texture_sampler.h"
#include "tests/bench/bench_report.h"
#include "tests/bench/measure.h"
#include "tests/support/box_scene.h"

#include <embree3/rtcore.h>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <limits>
#include <string>
#include <vector>

namespace waymark {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

// A mirror camera that looks up at its mirror.
Isometry3d UpPose(const Vector3d& p_W) {
  Isometry3d X_WC = Isometry3d::Identity();
  X_WC.linear().col(0) = -Vector3d::UnitY();
  X_WC.linear().col(1) = Vector3d::UnitX();
  X_WC.linear().col(2) = Vector3d::UnitZ();
  X_WC.translation() = p_W;
  return X_WC;
}

struct NamedView {
  std::string name;
  CameraView view;
  Isometry3d X_WC;
};

std::vector<NamedView> Views() {
  const Isometry3d X_WC = LookFrom({0.6, 0.9, 1.3}, 0.12, 0.08);
  return {{"perspective 640x480",
           {PerspectiveCamera({400.0, 400.0, 319.5, 239.5}), {640, 480}},
           X_WC},
          {"fisheye 640x480",
           {FisheyeCamera({230.0, 230.0, 319.5, 239.5}), {640, 480}},
           X_WC},
          {"sphere mirror 640x640",
           {SphereCamera(0.95, {250.0, 250.0, 319.5, 319.5}), {640, 640}},
           UpPose({3.0, 1.0, 1.0})},
          {"panorama 1024x256",
           {PanoramaCamera::WholeTurn({1024, 256}, 120.0), {1024, 256}},
           X_WC}};
}

// The corridor with one person in it.
struct Stage {
  Scene scene = FurnishedCorridor();
  std::vector<Isometry3d> X_WP{Isometry3d::Identity()};
  Stage() { X_WP[0].translation() = Vector3d(4.2, 0.9, 0.0); }
};

// ---- rays ------------------------------------------------------------------

// The same triangles and rays in a loop of Embree's own and nothing else: what
// the hardware can do. The person is a part of the mesh here.
class BareEmbree {
 public:
  BareEmbree(const Stage& stage,
             const CameraRays& camera,
             const Isometry3d& X_WC)
      : device_(rtcNewDevice("threads=1,set_affinity=0")),
        scene_(rtcNewScene(device_)) {
    rtcSetSceneFlags(scene_, RTC_SCENE_FLAG_ROBUST);
    rtcSetSceneBuildQuality(scene_, RTC_BUILD_QUALITY_HIGH);
    Add(stage.scene.mesh, Isometry3d::Identity());
    for (std::size_t i = 0; i < stage.X_WP.size(); ++i) {
      Add(stage.scene.movers[i].mesh, stage.X_WP[i]);
    }
    rtcCommitScene(scene_);
    for (int row = 0; row < camera.num_block_rows(); ++row) {
      for (int column = 0; column < camera.num_block_columns(); ++column) {
        AddRays(camera.block(row, column), X_WC);
      }
    }
  }
  ~BareEmbree() {
    rtcReleaseScene(scene_);
    rtcReleaseDevice(device_);
  }
  BareEmbree(const BareEmbree&) = delete;
  BareEmbree& operator=(const BareEmbree&) = delete;

  // Sum of the distances, so that nothing is left out.
  double Run() const {
    alignas(32) int valid[8];
    std::fill_n(valid, 8, -1);
    double sum = 0.0;
    for (const RTCRayHit8& ready : rays_) {
      RTCRayHit8 hits = ready;
      RTCIntersectContext context;
      rtcInitIntersectContext(&context);
      context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
      rtcIntersect8(valid, scene_, &context, &hits);
      sum += static_cast<double>(hits.ray.tfar[0]);
    }
    return sum;
  }

 private:
  void Add(const SceneMesh& mesh, const Isometry3d& X_WM) {
    RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* positions =
        static_cast<float*>(rtcSetNewGeometryBuffer(geometry,
                                                    RTC_BUFFER_TYPE_VERTEX,
                                                    0,
                                                    RTC_FORMAT_FLOAT3,
                                                    3 * sizeof(float),
                                                    mesh.positions.size()));
    for (const Eigen::Vector3f& p : mesh.positions) {
      const Eigen::Vector3f p_W = (X_WM * p.cast<double>()).cast<float>();
      positions = std::copy_n(p_W.data(), 3, positions);
    }
    auto* indices = static_cast<std::uint32_t*>(
        rtcSetNewGeometryBuffer(geometry,
                                RTC_BUFFER_TYPE_INDEX,
                                0,
                                RTC_FORMAT_UINT3,
                                3 * sizeof(std::uint32_t),
                                mesh.triangles.size()));
    for (const SceneTriangle& triangle : mesh.triangles) {
      indices = std::copy_n(triangle.vertices.data(), 3, indices);
    }
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene_, geometry);
    rtcReleaseGeometry(geometry);
  }

  void AddRays(const CameraRays::Block& block, const Isometry3d& X_WC) {
    RTCRayHit8 rays{};
    for (int i = 0; i < 8; ++i) {
      const Vector3d n_W = X_WC.linear() * Vector3d(block.direction[0][i],
                                                    block.direction[1][i],
                                                    block.direction[2][i]);
      rays.ray.org_x[i] = static_cast<float>(X_WC.translation().x());
      rays.ray.org_y[i] = static_cast<float>(X_WC.translation().y());
      rays.ray.org_z[i] = static_cast<float>(X_WC.translation().z());
      rays.ray.dir_x[i] = static_cast<float>(n_W.x());
      rays.ray.dir_y[i] = static_cast<float>(n_W.y());
      rays.ray.dir_z[i] = static_cast<float>(n_W.z());
      rays.ray.tfar[i] = std::numeric_limits<float>::infinity();
      rays.ray.mask[i] = ~0u;
      rays.hit.geomID[i] = RTC_INVALID_GEOMETRY_ID;
      rays.hit.instID[0][i] = RTC_INVALID_GEOMETRY_ID;
    }
    rays_.push_back(rays);
  }

  RTCDevice device_;
  RTCScene scene_;
  std::vector<RTCRayHit8> rays_;
};

std::vector<BenchRow> BenchRays(bool full) {
  const Stage stage;
  const Renderer renderer(stage.scene);
  const int num_runs = full ? 101 : 21;
  std::vector<BenchRow> rows;
  for (const NamedView& view : Views()) {
    const CameraRays camera(view.view);
    const BareEmbree bare(stage, camera, view.X_WC);
    const double num_rays = view.view.size.width * view.view.size.height;
    RenderOptions shaded;
    shaded.quality = RenderQuality::kSingle;
    RenderOptions depth;
    depth.image = false;
    depth.depth = true;
    std::vector<double> bare_s;
    std::vector<double> shaded_s;
    std::vector<double> depth_s;
    double sum = 0.0;
    for (int i = 0; i < num_runs; ++i) {
      bare_s.push_back(CpuSecondsOf([&] { sum += bare.Run(); }));
      shaded_s.push_back(CpuSecondsOf([&] {
        sum += renderer.Render(camera, view.X_WC, stage.X_WP, shaded)
                   .image(0, 0)[0];
      }));
      depth_s.push_back(CpuSecondsOf([&] {
        sum += static_cast<double>(
            renderer.Render(camera, view.X_WC, stage.X_WP, depth).depth(0, 0));
      }));
    }
    if (!(sum > 0.0)) std::printf("rays: nothing was met\n");
    const double peer = 1e-6 * num_rays / Median(bare_s);
    const auto row =
        [&](const std::string& what, double seconds, const std::string& goal) {
          BenchRow r;
          r.id = "simulator-rays";
          r.name = view.name + ", " + what;
          r.value = 1e-6 * num_rays / seconds;
          r.unit = "Mray/s of one core";
          r.peer = "bare Embree loop";
          r.peer_value = peer;
          r.ratio = r.value / peer;
          r.goal = goal;
          if (!goal.empty()) r.holds = *r.ratio >= 0.5;
          r.runs = num_runs;
          return r;
        };
    rows.push_back(
        row("one shaded sample a pixel", Median(shaded_s), "half of the peer"));
    rows.push_back(row("depth alone", Median(depth_s), ""));
  }
  return rows;
}

// ---- frames ----------------------------------------------------------------

double Psnr(const cv::Mat3b& a, const cv::Mat3b& b) {
  const double norm = cv::norm(a, b);
  const double mean = norm * norm / (3.0 * static_cast<double>(a.total()));
  return 10.0 * std::log10(255.0 * 255.0 / mean);
}

std::vector<BenchRow> BenchFrames(bool full) {
  const Stage stage;
  const Renderer renderer(stage.scene);
  const int num_runs = full ? 51 : 11;
  std::vector<BenchRow> rows;
  for (const NamedView& view : Views()) {
    const CameraRays camera(view.view);
    const auto render = [&](RenderQuality quality) {
      RenderOptions options;
      options.quality = quality;
      return renderer.Render(camera, view.X_WC, stage.X_WP, options).image;
    };
    cv::Mat3b live;
    cv::Mat3b still;
    std::vector<double> live_s;
    std::vector<double> still_s;
    for (int i = 0; i < num_runs; ++i) {
      live_s.push_back(
          CpuSecondsOf([&] { live = render(RenderQuality::kLive); }));
      if (i % 5 != 0) continue;
      still_s.push_back(
          CpuSecondsOf([&] { still = render(RenderQuality::kStill); }));
    }
    BenchRow frames;
    frames.id = "simulator-frames";
    frames.name = view.name + ", live";
    frames.value = 1.0 / Median(live_s);
    frames.unit = "frames/s of one core";
    // What the live simulation needs of two cores that do all the rest too.
    frames.goal = view.view.size.height == 640 ? ">= 8" : ">= 15";
    frames.holds = frames.value >= (view.view.size.height == 640 ? 8.0 : 15.0);
    frames.runs = num_runs;
    rows.push_back(frames);
    frames.name = view.name + ", still";
    frames.value = 1.0 / Median(still_s);
    frames.goal.clear();
    frames.holds.reset();
    frames.runs = static_cast<std::int64_t>(still_s.size());
    rows.push_back(frames);
    BenchRow quality;
    quality.id = "simulator-frames";
    quality.name = view.name + ", live against still";
    quality.value = Psnr(live, still);
    quality.unit = "dB";
    quality.peer = "one sample a pixel";
    quality.peer_value = Psnr(render(RenderQuality::kSingle), still);
    quality.goal = ">= 42";
    quality.holds = quality.value >= 42.0;
    quality.runs = 1;
    rows.push_back(quality);
  }
  return rows;
}

// ---- light -----------------------------------------------------------------

std::vector<BenchRow> BenchLight(bool full) {
  const Stage stage;
  const int num_runs = full ? 11 : 3;
  std::vector<double> seconds;
  double num_bytes = 0.0;
  for (int i = 0; i < num_runs; ++i) {
    seconds.push_back(CpuSecondsOf([&] {
      const Renderer renderer(stage.scene);
      num_bytes = static_cast<double>(renderer.num_bytes());
    }));
  }
  BenchRow time;
  time.id = "simulator-light";
  time.name = "light of a furnished corridor, 12 x 2 m";
  time.value = Median(seconds);
  time.unit = "s of one core";
  time.runs = num_runs;
  BenchRow memory = time;
  memory.name = "its memory, textures included";
  memory.value = 1e-6 * num_bytes;
  memory.unit = "MB";
  return {time, memory};
}

// ---- textures --------------------------------------------------------------

// What a texture costs at the start beside the reading of the same picture from
// a PNG, which is what a model with textures pays.
std::vector<BenchRow> BenchTextures(bool full) {
  const int num_runs = full ? 21 : 5;
  std::vector<BenchRow> rows;
  for (const PatternKind kind : {PatternKind::kPlaster,
                                 PatternKind::kCarpet,
                                 PatternKind::kNoticeboard,
                                 PatternKind::kPicture}) {
    PatternOptions options;
    options.kind = kind;
    std::vector<std::uint8_t> png;
    cv::imencode(".png", MakePattern(options).image, png);
    std::vector<double> draw_s;
    std::vector<double> filter_s;
    std::vector<double> peer_s;
    double num_pixels = 0.0;
    for (int i = 0; i < num_runs; ++i) {
      cv::Mat3b image;
      draw_s.push_back(
          CpuSecondsOf([&] { image = MakePattern(options).image; }));
      filter_s.push_back(CpuSecondsOf([&] { TextureSampler{image}; }));
      peer_s.push_back(
          CpuSecondsOf([&] { image = cv::imdecode(png, cv::IMREAD_COLOR); }));
      num_pixels = static_cast<double>(image.total());
    }
    const auto row = [&](const std::string& what, double seconds) {
      BenchRow r;
      r.id = "simulator-textures";
      r.name = NameOf(kind) + ", " + what;
      r.value = 1e-6 * num_pixels / seconds;
      r.unit = "Mpixel/s of one core";
      r.peer = "reading it from a PNG";
      r.peer_value = 1e-6 * num_pixels / Median(peer_s);
      r.ratio = r.value / *r.peer_value;
      r.runs = num_runs;
      return r;
    };
    rows.push_back(row("drawn", Median(draw_s)));
    rows.push_back(row("made ready for sampling", Median(filter_s)));
  }
  return rows;
}

}  // namespace
}  // namespace waymark

int main(int argc, char** argv) {
  return waymark::RunBenches(
      argc,
      argv,
      "simulator",
      {{"simulator-rays",
        "rays per second beside a bare Embree loop",
        waymark::BenchRays},
       {"simulator-frames",
        "frames per second and quality, by camera model",
        waymark::BenchFrames},
       {"simulator-light", "time and memory of the light", waymark::BenchLight},
       {"simulator-textures",
        "time of textures at the start",
        waymark::BenchTextures}});
}
