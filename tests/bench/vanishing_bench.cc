// Vanishing points: the paper's and ours along corridors.

#include "estimation/base/random.h"
#include "estimation/geometry/angle.h"
#include "estimation/lines/furthest_removal.h"
#include "estimation/lines/line_extractor.h"
#include "estimation/lines/vanishing_point.h"
#include "tests/bench/bench_report.h"
#include "tests/bench/line_frames.h"
#include "tests/bench/measure.h"
#include "tests/bench/vanishing_peers.h"
#include "tests/bench/york_bench.h"

#include <Eigen/Geometry>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace waymark {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

// ---- Y5 and Y7: along rendered corridors -----------------------------------

constexpr double kPriorRad = 0.0873;  // 5 degrees, 1 sigma.
// What a found direction may be off and still be that of the corridor: "in the
// right cluster".
const double kRightRad = RadiansFromDegrees(2.0);

struct CorridorLines {
  std::vector<LineSegment> segments;
  Vector3d axis_C;
  Vector3d gravity_C;
  double prior_heading;  // The truth with an error of kPriorRad.
};

// Of Y5 and Y7: the worlds' light takes longer than all the rest.
const std::vector<CorridorLines>& LinesAlongCorridors(bool full) {
  static std::vector<CorridorLines> all;
  if (!all.empty()) return all;
  LineExtractor extractor;
  Random random(SeedFor(1, "vanishing_bench"));
  for (const LineFrame& frame : CorridorFrames(full ? 250 : 25)) {
    CorridorLines lines;
    lines.segments = extractor.Extract(frame.image).segments;
    lines.axis_C = frame.R_WC.transpose() * Vector3d::UnitX();
    if (lines.axis_C.z() < 0.0) lines.axis_C = -lines.axis_C;
    lines.gravity_C = frame.R_WC.transpose() * -Vector3d::UnitZ();
    lines.prior_heading =
        HeadingOf(lines.axis_C, lines.gravity_C) + random.Normal(kPriorRad);
    all.push_back(std::move(lines));
  }
  return all;
}

DirectionPrior PriorOf(const CorridorLines& lines) {
  return {DirectionOfHeading(lines.prior_heading, lines.gravity_C), kPriorRad};
}

// How far off a method was, and how long it took.
struct Outcome {
  std::vector<double> headings_rad;  // In the right cluster.
  std::vector<double> pixels;        // Of the vanishing point, the same ones.
  std::vector<double> seconds;       // All.
  std::size_t num_frames = 0;

  [[nodiscard]] double RightPercent() const {
    return 100.0 * static_cast<double>(headings_rad.size()) /
           static_cast<double>(num_frames);
  }
};

using FindDirection =
    std::function<std::optional<Vector3d>(const CorridorLines&)>;

Outcome Measure(const std::vector<CorridorLines>& frames,
                const FindDirection& find) {
  Outcome outcome;
  const auto pixel = [](const Vector3d& n) {
    return Vector2d(kCorridorView.fx * n.x() / n.z(),
                    kCorridorView.fy * n.y() / n.z());
  };
  for (const CorridorLines& frame : frames) {
    ++outcome.num_frames;
    std::optional<Vector3d> found;
    outcome.seconds.push_back(CpuSecondsOf([&] { found = find(frame); }));
    if (!found) continue;
    const double angle =
        std::atan2(found->cross(frame.axis_C).norm(), found->dot(frame.axis_C));
    if (angle > kRightRad) continue;
    outcome.headings_rad.push_back(
        std::abs(WrapAngle(HeadingOf(*found, frame.gravity_C) -
                           HeadingOf(frame.axis_C, frame.gravity_C))));
    outcome.pixels.push_back((pixel(*found) - pixel(frame.axis_C)).norm());
  }
  return outcome;
}

std::optional<Vector3d> Published(const CorridorLines& frame,
                                  const DirectionPrior& prior) {
  const auto found =
      FindVanishingPoint(frame.segments, kCorridorView, prior, {});
  if (!found) return std::nullopt;
  return found->n_C;
}

std::vector<BenchRow> BenchGate(bool full) {
  const std::vector<CorridorLines>& frames = LinesAlongCorridors(full);
  std::vector<BenchRow> rows;
  const Outcome gated = Measure(frames, [](const CorridorLines& frame) {
    return Published(frame, PriorOf(frame));
  });
  // As wide as it goes: 80 degrees to all sides.
  const Outcome open = Measure(frames, [](const CorridorLines& frame) {
    return Published(frame, {PriorOf(frame).n_C, 0.5});
  });
  double num_gated = 0.0;
  double num_open = 0.0;
  for (const CorridorLines& frame : frames) {
    DirectionPrior prior = PriorOf(frame);
    const auto count = [&] {
      const auto found =
          FindVanishingPoint(frame.segments, kCorridorView, prior, {});
      return found ? found->num_intersections : 0;
    };
    num_gated += count();
    prior.sigma_rad = 0.5;
    num_open += count();
  }
  const auto n = static_cast<double>(frames.size());
  const auto add = [&](const std::string& name,
                       const std::string& unit,
                       double value,
                       double peer,
                       double ratio) {
    rows.push_back(RowOf("Y5", name, value, unit, frames.size()));
    rows.back().peer = "no gate";
    rows.back().peer_value = peer;
    rows.back().ratio = ratio;
  };
  add("intersections a frame, gate of 3 sigma (15 deg)",
      "",
      num_gated / n,
      num_open / n,
      num_open / num_gated);
  add("published vanishing point within 2 deg",
      "%",
      gated.RightPercent(),
      open.RightPercent(),
      gated.RightPercent() / std::max(1e-9, open.RightPercent()));
  rows.back().goal = "more than without";
  rows.back().holds = gated.RightPercent() > open.RightPercent();
  add("published vanishing point",
      "ms",
      1e3 * Median(gated.seconds),
      1e3 * Median(open.seconds),
      Median(open.seconds) / Median(gated.seconds));
  return rows;
}

std::vector<BenchRow> BenchCorridors(bool full) {
  const std::vector<CorridorLines>& frames = LinesAlongCorridors(full);
  const Outcome peer = Measure(frames, [](const CorridorLines& frame) {
    return RansacVanishingPoint(frame.segments,
                                kCorridorView,
                                PriorOf(frame),
                                VanishingPointOptions().gate_sigmas);
  });
  std::vector<std::pair<std::string, Outcome>> methods;
  methods.emplace_back("furthest removal",
                       Measure(frames, [](const CorridorLines& frame) {
                         return Published(frame, PriorOf(frame));
                       }));
  methods.emplace_back(
      "known gravity (ours)",
      Measure(frames,
              [](const CorridorLines& frame) -> std::optional<Vector3d> {
                const auto found = FindHorizontalDirections(
                    frame.segments,
                    kCorridorView,
                    frame.gravity_C,
                    HeadingPrior{frame.prior_heading, kPriorRad},
                    {});
                if (found.empty()) return std::nullopt;
                return found[0].n_C;
              }));
  std::vector<BenchRow> rows;
  for (const auto& [name, outcome] : methods) {
    const auto add = [&, &name = name](const std::string& what,
                                       const std::string& unit,
                                       double value,
                                       double peer_value,
                                       bool is_more_better) {
      rows.push_back(
          RowOf("Y7", name + ", " + what, value, unit, frames.size()));
      rows.back().peer = "RANSAC of intersections";
      rows.back().peer_value = peer_value;
      rows.back().ratio = is_more_better ? value / std::max(1e-9, peer_value)
                                         : peer_value / std::max(1e-9, value);
    };
    const auto degrees = [](const std::vector<double>& values, double share) {
      return DegreesFromRadians(Quantile(values, share));
    };
    add("within 2 deg", "%", outcome.RightPercent(), peer.RightPercent(), true);
    add("heading of those, median",
        "deg",
        degrees(outcome.headings_rad, 0.5),
        degrees(peer.headings_rad, 0.5),
        false);
    rows.back().published = 0.3;
    rows.back().goal = "<= 0.3";
    rows.back().holds = rows.back().value <= 0.3;
    add("heading of those, p95",
        "deg",
        degrees(outcome.headings_rad, 0.95),
        degrees(peer.headings_rad, 0.95),
        false);
    add("vanishing point of those, median",
        "px",
        Median(outcome.pixels),
        Median(peer.pixels),
        false);
    rows.back().published = 2.0;
    rows.back().goal = "<= 2";
    rows.back().holds = rows.back().value <= 2.0;
    add("time",
        "ms",
        1e3 * Median(outcome.seconds),
        1e3 * Median(peer.seconds),
        false);
  }
  return rows;
}

// ---- Y6: removal of the furthest -------------------------------------------

// A dense middle and points all around, as intersections are.
std::vector<Vector2d> Intersections(int num) {
  Random random(SeedFor(static_cast<std::uint64_t>(num), "Intersections"));
  std::vector<Vector2d> points;
  for (int i = 0; i < num; ++i) {
    const double sigma = i % 3 == 0 ? 1.0 : 0.02;
    const double x = random.Normal(sigma);
    points.emplace_back(x, random.Normal(sigma));
  }
  return points;
}

std::vector<BenchRow> BenchRemoval(bool full) {
  constexpr int kKept = 30;
  std::vector<BenchRow> rows;
  double first = 0.0;
  for (const int num : {1000, 4000, 16000, 64000}) {
    const std::vector<Vector2d> points = Intersections(num);
    const bool has_peer = full || num <= 16000;
    std::vector<double> ours;
    std::vector<double> peers;
    FurthestRemoval removal;
    std::vector<int> plain;
    for (int i = 0; i < (num > 4000 ? 1 : 5); ++i) {
      ours.push_back(
          CpuSecondsOf([&] { removal = RemoveFurthest(points, kKept); }));
      if (!has_peer) continue;
      peers.push_back(
          CpuSecondsOf([&] { plain = PlainFurthestRemoval(points, kKept); }));
    }
    const std::string of = " of " + std::to_string(num) + " points";
    rows.push_back(
        RowOf("Y6", "removal" + of, 1e3 * Median(ours), "ms", ours.size()));
    if (has_peer) {
      rows.back().peer = "all points each time";
      rows.back().peer_value = 1e3 * Median(peers);
      rows.back().ratio = Median(peers) / Median(ours);
      rows.back().goal = "faster, same order";
      rows.back().holds = *rows.back().ratio > 1.0 && plain == removal.removed;
    }
    const double relative =
        static_cast<double>(removal.num_visits) / (num * std::log2(num));
    if (num == 1000) first = relative;
    rows.push_back(RowOf(
        "Y6", "visits over n log2 n" + of, relative / first, "of 1000's", 1));
    rows.back().goal = "<= 1.2";
    rows.back().holds = rows.back().value <= 1.2;
  }
  return rows;
}

}  // namespace
}  // namespace waymark

int main(int argc, char** argv) {
  return waymark::RunBenches(
      argc,
      argv,
      "vanishing",
      {{"Y5", "gate of the published vanishing point", waymark::BenchGate},
       {"Y6", "removal of the furthest", waymark::BenchRemoval},
       {"Y7", "vanishing points along corridors", waymark::BenchCorridors},
       {"Y8", "directions of photographs (York)", waymark::BenchYork}});
}
