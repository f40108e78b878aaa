// Cameras beside OpenCV's: calibration from boards, rays and pixels.

#include "estimation/camera/board_detector.h"
#include "tests/bench/bench_report.h"
#include "tests/bench/measure.h"
#include "tests/bench/opencv_cameras.h"
#include "tests/support/board_views.h"
#include "tests/support/real_data.h"

#include <opencv2/core/utility.hpp>
#include <opencv2/imgcodecs.hpp>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

namespace waymark {
namespace {

double Seconds() {
  return std::chrono::duration<double>(
             std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

BenchRow Beside(BenchRow row,
                const std::string& peer,
                double peer_value,
                const std::string& goal,
                bool holds) {
  row.peer = peer;
  row.peer_value = peer_value;
  if (row.value > 0.0) row.ratio = peer_value / row.value;
  row.goal = goal;
  if (!goal.empty()) row.holds = holds;
  return row;
}

std::string PeerName(CameraKind kind) {
  if (kind == CameraKind::kPerspective) return "cv::calibrateCamera";
  if (kind == CameraKind::kFisheye) return "cv::fisheye::calibrate";
  return "cv::omnidir::calibrate";
}

// ---- camera-mirror ---------------------------------------------------------

std::vector<BoardView> RealViews(const std::string& folder, ImageSize* size) {
  const ChessBoard board{.columns = 8, .rows = 6, .square = 0.042};
  std::vector<BoardView> views;
  for (int i = 1; i <= 6; ++i) {
    const cv::Mat image =
        cv::imread(folder + "/img_para_00" + std::to_string(i) + ".png",
                   cv::IMREAD_GRAYSCALE);
    if (image.empty()) continue;
    *size = {image.cols, image.rows};
    if (auto corners = FindBoardCorners(image, board)) {
      views.push_back({std::move(*corners), board.Corners()});
    }
  }
  return views;
}

double LargestDistance(const CameraCalibration& calibration) {
  double largest = 0.0;
  for (const ViewCalibration& view : calibration.views) {
    largest = std::max(largest, view.max_px);
  }
  return largest;
}

void AddMirror(const std::vector<BoardView>& views,
               const CalibrationOptions& options,
               std::vector<BenchRow>* rows) {
  const auto num_views = static_cast<std::int64_t>(views.size());
  double begin = Seconds();
  const CalibrationReport ours = CalibrateCamera(views, options);
  const double our_time = Seconds() - begin;
  begin = Seconds();
  const auto peer = CalibrateWithOpenCv(views, options);
  const double peer_time = Seconds() - begin;
  const std::string name = options.xi ? "xi = 1: " : "xi free: ";
  if (!ours.result) {
    std::printf("%sno answer: %s\n", name.c_str(), ours.reason.c_str());
    return;
  }
  const std::string of = PeerName(options.kind);
  const auto row = [&](const char* what, double value, const char* unit) {
    return RowOf("camera-mirror", name + what, value, unit, num_views);
  };
  rows->push_back(row("RMS of all corners", ours.result->rms_px, "px"));
  rows->push_back(
      row("largest distance of a corner", LargestDistance(*ours.result), "px"));
  rows->push_back(row("time", 1e3 * our_time, "ms"));
  if (!peer) return;
  rows->back() = Beside(rows->back(), of, 1e3 * peer_time, "", true);
  // OpenCV leaves views out that its start does not suit.
  std::vector<BoardView> same;
  for (const int i : peer->used) {
    same.push_back(views[static_cast<std::size_t>(i)]);
  }
  const CalibrationReport again = CalibrateCamera(same, options);
  if (!again.result) return;
  // What both round away.
  constexpr double kSame = 1.001;
  rows->push_back(Beside(
      row("RMS over the views that OpenCV takes", again.result->rms_px, "px"),
      of,
      peer->rms_px,
      "no worse",
      again.result->rms_px <= kSame * peer->rms_px));
  rows->back().runs = static_cast<std::int64_t>(same.size());
}

std::vector<BenchRow> BenchMirror(bool) {
  const std::string folder = RealDataFolder("mei_catadioptric_calib");
  if (folder.empty()) {
    std::printf("skipped: no mei_catadioptric_calib (set WAYMARK_DATA)\n");
    return {};
  }
  CalibrationOptions options;
  options.kind = CameraKind::kSphere;
  options.is_mirrored = true;
  options.xi = 1.0;
  options.num_distortion = 2;
  // All corners, as OpenCV takes them.
  options.max_corner_sigmas = 1e6;
  const std::vector<BoardView> views = RealViews(folder, &options.size);
  const auto num_views = static_cast<std::int64_t>(views.size());
  std::vector<BenchRow> rows{RowOf(
      "camera-mirror", "boards found", static_cast<double>(num_views), "", 6)};
  rows.back().goal = "6";
  rows.back().holds = num_views == 6;
  AddMirror(views, options, &rows);
  options.xi.reset();
  AddMirror(views, options, &rows);
  return rows;
}

// ---- camera-boards ---------------------------------------------------------

// Root mean square of the angles between the rays of both cameras, over pixels
// all over the image that have one in both. The angle that a turn of the whole
// camera explains counts too: nothing else says where forward is.
double RayError(const CameraModel& found,
                const CameraModel& truth,
                const ImageSize& size) {
  constexpr int kSteps = 24;
  double sum = 0.0;
  int num = 0;
  for (int i = 0; i <= kSteps; ++i) {
    for (int k = 0; k <= kSteps; ++k) {
      const Eigen::Vector2d pixel(i * (size.width - 1.0) / kSteps,
                                  k * (size.height - 1.0) / kSteps);
      const auto a = RayFromPixel(found, pixel);
      const auto b = RayFromPixel(truth, pixel);
      if (!a || !b) continue;
      sum += std::pow(
          std::atan2(a->ray.cross(b->ray).norm(), a->ray.dot(b->ray)), 2);
      ++num;
    }
  }
  return std::sqrt(sum / std::max(num, 1));
}

struct Scores {
  std::vector<double> rms_px;
  std::vector<double> focal;  // |error| / truth.
  std::vector<double> rays;   // rad.
  std::vector<double> times;  // s, of all seeds.
  int num_wrong = 0;          // No answer, or one far off.

  void Add(const CameraModel& found,
           double rms,
           const CalibrationCase& c,
           double noise_px) {
    // Twice what the corners' noise leaves: another minimum.
    if (!(rms < 2.0 * std::sqrt(2.0) * noise_px)) {
      ++num_wrong;
      return;
    }
    rms_px.push_back(rms);
    const double truth = ParametersOf(c.camera)(0);
    focal.push_back(std::abs(ParametersOf(found)(0) - truth) / truth);
    rays.push_back(RayError(found, c.camera, c.options.size));
  }
};

void AddScores(const CalibrationCase& c,
               int num_seeds,
               const Scores& ours,
               const Scores& peers,
               std::vector<BenchRow>* rows) {
  const std::string of = PeerName(c.options.kind);
  const auto row = [&](const std::string& name,
                       double value,
                       const char* unit) {
    return RowOf("camera-boards", c.name + ": " + name, value, unit, num_seeds);
  };
  BenchRow wrong = row("no or a wrong answer", ours.num_wrong, "");
  rows->push_back(Beside(wrong, of, peers.num_wrong, "0", ours.num_wrong == 0));
  rows->push_back(Beside(row("median time", 1e3 * Median(ours.times), "ms"),
                         of,
                         1e3 * Median(peers.times),
                         "",
                         true));
  if (ours.rays.empty()) return;
  // Medians over other seeds say nothing about each other.
  if (peers.rays.size() != ours.rays.size()) {
    rows->push_back(row("median RMS of rays", 1e3 * Median(ours.rays), "mrad"));
    return;
  }
  const auto add = [&](const std::string& name,
                       const std::vector<double>& a,
                       const std::vector<double>& b,
                       double unit,
                       const char* unit_name) {
    // Both minimise the same sum: what differs is where they stop.
    constexpr double kSame = 1.02;
    const double value = Median(a);
    const double peer = Median(b);
    rows->push_back(Beside(row(name, unit * value, unit_name),
                           of,
                           unit * peer,
                           "no worse",
                           value <= kSame * peer));
  };
  add("median RMS of corners", ours.rms_px, peers.rms_px, 1.0, "px");
  add("median error of fx", ours.focal, peers.focal, 1e2, "%");
  add("median RMS of rays", ours.rays, peers.rays, 1e3, "mrad");
}

std::vector<CalibrationCase> BoardCases() {
  std::vector<CalibrationCase> cases = CalibrationCases();
  // OpenCV's fisheye takes no corner beside or behind the camera.
  CalibrationCase ahead = cases[1];
  ahead.name = "fisheye within 75 degrees";
  ahead.camera = FisheyeCamera({640.0, 641.0, 633.0, 520.0},
                               {0.03, -0.012, 0.004, -0.001});
  cases.push_back(std::move(ahead));
  return cases;
}

std::vector<BenchRow> BenchBoards(bool full) {
  constexpr double kNoise = 0.3;
  constexpr int kViews = 8;
  const int num_seeds = full ? 200 : 20;
  std::vector<BenchRow> rows;
  for (const CalibrationCase& c : BoardCases()) {
    Scores ours;
    Scores peers;
    for (int seed = 0; seed < num_seeds; ++seed) {
      Random random(Random(static_cast<std::uint64_t>(seed)).Bits());
      const BoardScene scene =
          MakeBoardScene(c.camera, c.options.size, kViews, kNoise, &random);
      double begin = Seconds();
      const CalibrationReport report = CalibrateCamera(scene.views, c.options);
      ours.times.push_back(Seconds() - begin);
      if (report.result) {
        ours.Add(report.result->camera, report.result->rms_px, c, kNoise);
      } else {
        ++ours.num_wrong;
      }
      begin = Seconds();
      const auto peer = CalibrateWithOpenCv(scene.views, c.options);
      peers.times.push_back(Seconds() - begin);
      if (peer && peer->used.size() == kViews) {
        peers.Add(peer->camera, peer->rms_px, c, kNoise);
      } else {
        ++peers.num_wrong;
      }
    }
    AddScores(c, num_seeds, ours, peers, &rows);
  }
  return rows;
}

// ---- camera-speed ----------------------------------------------------------

// Nanoseconds per item: the least of some rounds, which other work on the
// machine disturbed least.
template <typename Function>
double Nanoseconds(std::size_t num_items, int rounds, Function&& run) {
  double least = 1e30;
  for (int i = 0; i < rounds; ++i) {
    const double begin = Seconds();
    run();
    least = std::min(least, Seconds() - begin);
  }
  return 1e9 * least / static_cast<double>(num_items);
}

struct SpeedSamples {
  std::vector<Eigen::Vector2d> pixels;
  std::vector<Eigen::Vector3d> points;  // That they see.
};

// Rays within 70 degrees of forward: OpenCV's fisheye gives none beside or
// behind the camera. So few that a round is over before the machine turns to
// something else.
SpeedSamples MakeSamples(const CalibrationCase& c) {
  constexpr std::size_t kNum = 2000;
  constexpr double kMinZ = 0.34;
  Random random(3);
  SpeedSamples samples;
  while (samples.pixels.size() < kNum) {
    const double u = random.Uniform(0.0, c.options.size.width);
    const double v = random.Uniform(0.0, c.options.size.height);
    const auto back = RayFromPixel(c.camera, {u, v});
    if (!back || back->ray.z() < kMinZ) continue;
    samples.pixels.emplace_back(u, v);
    samples.points.push_back(2.0 * back->ray);
  }
  return samples;
}

struct Timed {
  double ours_ns = 0.0;
  double theirs_ns = 0.0;
  double largest_gap = 0.0;  // Between what both say.
};

Timed TimePixels(const CameraModel& camera,
                 const SpeedSamples& samples,
                 int rounds) {
  const std::size_t num = samples.points.size();
  Timed timed;
  std::vector<Eigen::Vector2d> ours(num);
  timed.ours_ns = Nanoseconds(num, rounds, [&] {
    for (std::size_t i = 0; i < num; ++i) {
      ours[i] = PixelFromRay(camera, samples.points[i])->pixel;
    }
  });
  std::vector<Eigen::Vector2d> theirs;
  timed.theirs_ns = Nanoseconds(
      num, rounds, [&] { theirs = ProjectWithOpenCv(camera, samples.points); });
  for (std::size_t i = 0; i < num; ++i) {
    timed.largest_gap =
        std::max(timed.largest_gap, (ours[i] - theirs[i]).norm());
  }
  return timed;
}

Timed TimeRays(const CameraModel& camera,
               const SpeedSamples& samples,
               int rounds) {
  const std::size_t num = samples.points.size();
  Timed timed;
  std::vector<Eigen::Vector3d> ours(num);
  timed.ours_ns = Nanoseconds(num, rounds, [&] {
    for (std::size_t i = 0; i < num; ++i) {
      ours[i] = RayFromPixel(camera, samples.pixels[i])->ray;
    }
  });
  // As many steps as bring the perspective camera's iteration as close as the
  // others' come.
  constexpr int kSteps = 20;
  std::vector<Eigen::Vector2d> theirs;
  timed.theirs_ns = Nanoseconds(num, rounds, [&] {
    theirs = UndistortWithOpenCv(camera, samples.pixels, kSteps);
  });
  for (std::size_t i = 0; i < num; ++i) {
    timed.largest_gap =
        std::max(timed.largest_gap,
                 (ours[i] - theirs[i].homogeneous().normalized()).norm());
  }
  return timed;
}

std::vector<BenchRow> BenchSpeed(bool full) {
  cv::setNumThreads(1);
  const int rounds = full ? 2000 : 200;
  std::vector<BenchRow> rows;
  for (const CalibrationCase& c : CalibrationCases()) {
    if (c.options.xi) continue;  // As the mirror.
    const SpeedSamples samples = MakeSamples(c);
    const auto runs = static_cast<std::int64_t>(samples.points.size()) * rounds;
    const auto row = [&](const char* name, double value, const char* unit) {
      return RowOf("camera-speed", c.name + ": " + name, value, unit, runs);
    };
    const Timed pixels = TimePixels(c.camera, samples, rounds);
    rows.push_back(
        Beside(row("PixelFromRay with Jacobian", pixels.ours_ns, "ns"),
               "projectPoints, without",
               pixels.theirs_ns,
               "",
               true));
    rows.push_back(row("gap of pixels", pixels.largest_gap, "px"));
    rows.back().goal = "<= 1e-9";
    rows.back().holds = pixels.largest_gap <= 1e-9;
    const Timed rays = TimeRays(c.camera, samples, rounds);
    rows.push_back(Beside(row("RayFromPixel with Jacobian", rays.ours_ns, "ns"),
                          "undistortPoints, without",
                          rays.theirs_ns,
                          "",
                          true));
    rows.push_back(row("gap of rays", rays.largest_gap, "rad"));
  }
  return rows;
}

}  // namespace
}  // namespace waymark

int main(int argc, char** argv) {
  return waymark::RunBenches(
      argc,
      argv,
      "camera",
      {{"camera-mirror",
        "calibration of a real mirror camera",
        waymark::BenchMirror},
       {"camera-boards",
        "calibration from simulated boards, against the truth",
        waymark::BenchBoards},
       {"camera-speed",
        "time of a pixel's ray and of a ray's pixel",
        waymark::BenchSpeed}});
}
