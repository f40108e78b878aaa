#include "tests/bench/line_frames.h"

#include "drivers/simulator/build_scene.h"
#include "drivers/simulator/renderer.h"
#include "drivers/simulator/scene_edges.h"
#include "estimation/base/random.h"
#include "estimation/geometry/angle.h"
#include "processes/convert/world_file.h"
#include "tests/bench/measure.h"
#include "tests/support/real_data.h"

#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <cmath>
#include <filesystem>

namespace waymark {
namespace {

using Eigen::Vector2d;

constexpr double kMatchPx = 1.5;
constexpr double kMatchRad = 0.01745;
constexpr double kEdgePx = 20.0;
// So near to an edge a segment is meant to be that edge.
constexpr double kNearPx = 6.0;
constexpr double kNearRad = 0.0873;
constexpr double kPrecision = 0.9;

cv::Mat1b GreyWithNoise(const cv::Mat3b& image, Random* random) {
  cv::Mat1b grey;
  cv::cvtColor(image, grey, cv::COLOR_BGR2GRAY);
  for (std::uint8_t& pixel : grey) {
    pixel = cv::saturate_cast<std::uint8_t>(pixel + random->Normal(1.5));
  }
  return grey;
}

// Of a camera that looks level, `yaw` from W's x toward its y.
Eigen::Isometry3d LevelPose(const Eigen::Vector3d& p_W, double yaw) {
  const Eigen::Vector3d ahead(std::cos(yaw), std::sin(yaw), 0.0);
  Eigen::Isometry3d X_WC = Eigen::Isometry3d::Identity();
  X_WC.linear().col(0) = ahead.cross(Eigen::Vector3d::UnitZ());
  X_WC.linear().col(1) = -Eigen::Vector3d::UnitZ();
  X_WC.linear().col(2) = ahead;
  X_WC.translation() = p_W;
  return X_WC;
}

// Of a segment beside an edge.
struct Match {
  double offset = 0.0;
  double begin = 0.0;  // Where it covers the edge, px from its a.
  double end = 0.0;
};

bool Matches(const FoundSegment& s,
             const TrueEdge& e,
             double max_px,
             double max_rad,
             Match* match) {
  const Vector2d d = (e.b - e.a).normalized();
  const Vector2d t = s.b - s.a;
  const double length = t.norm();
  if (std::abs(d.x() * t.y() - d.y() * t.x()) > std::sin(max_rad) * length) {
    return false;
  }
  const auto across = [&](const Vector2d& p) {
    return d.x() * (p.y() - e.a.y()) - d.y() * (p.x() - e.a.x());
  };
  if (std::abs(across(s.a)) > max_px || std::abs(across(s.b)) > max_px) {
    return false;
  }
  const double first = d.dot(s.a - e.a);
  const double second = d.dot(s.b - e.a);
  match->begin = std::max(0.0, std::min(first, second));
  match->end = std::min((e.b - e.a).norm(), std::max(first, second));
  match->offset = across(0.5 * (s.a + s.b));
  return match->end - match->begin >= 0.5 * length;
}

// Whether all of a segment lies on drawn surfaces.
bool IsDrawn(const cv::Mat1b& drawn, const FoundSegment& s) {
  if (drawn.empty()) return false;
  const int num = static_cast<int>((s.b - s.a).norm()) + 1;
  for (int i = 0; i <= num; ++i) {
    const Vector2d p = s.a + static_cast<double>(i) / num * (s.b - s.a);
    const int x = static_cast<int>(std::lround(p.x()));
    const int y = static_cast<int>(std::lround(p.y()));
    if (drawn(std::clamp(y, 0, drawn.rows - 1),
              std::clamp(x, 0, drawn.cols - 1)) == 0) {
      return false;
    }
  }
  return true;
}

// 255 where a surface with a texture is seen.
cv::Mat1b DrawnOf(const Scene& scene, const cv::Mat1i& surface) {
  std::vector<char> is_drawn(scene.surfaces.size(), 0);
  for (const SceneTriangle& triangle : scene.mesh.triangles) {
    if (scene.materials[triangle.material].texture.total() > 1) {
      is_drawn[triangle.surface] = 1;
    }
  }
  cv::Mat1b drawn(surface.size(), 0);
  for (int y = 0; y < surface.rows; ++y) {
    for (int x = 0; x < surface.cols; ++x) {
      const int id = surface(y, x);
      if (id >= 0 && is_drawn[static_cast<std::size_t>(id)] != 0) {
        drawn(y, x) = 255;
      }
    }
  }
  return drawn;
}

// How much of a segment can be seen: grey levels times root pixels.
double StrengthOf(const cv::Mat1b& image, const FoundSegment& s) {
  // Beyond the blur of an edge, short of its neighbours.
  constexpr double kAsidePx = 2.0;
  const double length = (s.b - s.a).norm();
  const Vector2d d = (s.b - s.a) / std::max(1e-9, length);
  const Vector2d aside(-kAsidePx * d.y(), kAsidePx * d.x());
  const auto grey = [&](const Vector2d& p) {
    const int x = static_cast<int>(std::lround(p.x()));
    const int y = static_cast<int>(std::lround(p.y()));
    return static_cast<double>(image(std::clamp(y, 0, image.rows - 1),
                                     std::clamp(x, 0, image.cols - 1)));
  };
  const int num = static_cast<int>(length) + 1;
  double sum = 0.0;
  for (int i = 0; i < num; ++i) {
    const Vector2d p = s.a + (i + 0.5) / num * (s.b - s.a);
    sum += grey(p + aside) - grey(p - aside);
  }
  return std::abs(sum) / num * std::sqrt(length);
}

// What every threshold is scored from.
struct Segment {
  double strength;
  bool is_match;
  double offset;
  double sigma_px;
};
struct Cover {
  double strength;  // Of the segment.
  double begin;
  double end;
};

double CoveredBy(std::vector<Cover> covers, double threshold) {
  std::erase_if(covers, [&](const Cover& c) { return c.strength < threshold; });
  std::sort(covers.begin(), covers.end(), [](const Cover& a, const Cover& b) {
    return a.begin < b.begin;
  });
  double covered = 0.0;
  double reach = 0.0;
  for (const Cover& c : covers) {
    covered += std::max(0.0, c.end - std::max(reach, c.begin));
    reach = std::max(reach, c.end);
  }
  return covered;
}

}  // namespace

std::vector<LineFrame> RenderedLineFrames(int num_per_world, FrameLooks looks) {
  const bool is_plain = looks == FrameLooks::kPlain;
  const std::string first = is_plain ? "corridor_plain" : "corridor_textured";
  std::vector<LineFrame> frames;
  for (const std::string& name : {first, std::string("corridor_office")}) {
    const World world = LoadWorldFile(FindWorldFile(name));
    const Scene scene =
        is_plain ? BuildScene(world, SceneLooks::kPlain) : BuildScene(world);
    const Renderer renderer(scene);
    const SceneEdges edges(scene);
    const CameraView view{PerspectiveCamera({400.0, 400.0, 319.5, 239.5}),
                          {640, 480}};
    const CameraRays rays(view);
    Random random(SeedFor(1, name));
    const std::vector<Eigen::Isometry3d> X_WP(scene.movers.size(),
                                              Eigen::Isometry3d::Identity());
    for (int i = 0; i < num_per_world; ++i) {
      const double x = random.Uniform(1.0, 13.0);
      const double y = random.Uniform(0.5, 1.5);
      const Eigen::Isometry3d X_WC =
          LevelPose({x, y, 0.6}, random.Uniform(-0.44, 0.44));
      LineFrame frame;
      frame.name = name + " " + std::to_string(i);
      RenderOptions render;
      render.surface = !is_plain;
      const RenderedView seen = renderer.Render(rays, X_WC, X_WP, render);
      frame.image = GreyWithNoise(seen.image, &random);
      if (!is_plain) frame.drawn = DrawnOf(scene, seen.surface);
      for (const VisibleEdge& edge :
           edges.Find(renderer.caster(), view, X_WC, X_WP)) {
        frame.edges.push_back({edge.pixels.front(), edge.pixels.back()});
      }
      frames.push_back(std::move(frame));
    }
  }
  return frames;
}

std::vector<LineFrame> CorridorFrames(int num_per_world) {
  struct Corridor {
    std::string name;
    double length;    // Along W's x, m.
    double centre_y;  // Between its walls, m.
  };
  constexpr double kReachY = 0.6;  // Of the robot's centre to either side.
  constexpr double kMaxYaw = 0.436;
  constexpr double kTilt = 0.087;
  constexpr double kMaxRoll = 0.05;
  const CameraView view{PerspectiveCamera({kCorridorView.fx,
                                           kCorridorView.fy,
                                           kCorridorView.cx,
                                           kCorridorView.cy}),
                        {640, 480}};
  const CameraRays rays(view);
  std::vector<LineFrame> frames;
  for (const Corridor& corridor : {Corridor{"corridor_plain", 20.0, 1.0},
                                   Corridor{"corridor_textured", 20.0, 1.0},
                                   Corridor{"corridor_office", 24.0, 1.1},
                                   Corridor{"corridor_mouth", 14.0, 0.95}}) {
    const World world = LoadWorldFile(FindWorldFile(corridor.name));
    const Scene scene = BuildScene(world);
    const Renderer renderer(scene);
    Random random(SeedFor(2, corridor.name));
    // People stand in a corner of the building, behind its walls.
    const std::vector<Eigen::Isometry3d> X_WP(scene.movers.size(),
                                              Eigen::Isometry3d::Identity());
    for (int i = 0; i < num_per_world;) {
      const Vector2d at(random.Uniform(0.5, corridor.length - 0.5),
                        corridor.centre_y + random.Uniform(-kReachY, kReachY));
      const bool is_free = std::all_of(world.furniture.begin(),
                                       world.furniture.end(),
                                       [&](const auto& thing) {
                                         return (thing.at - at).norm() >
                                                0.5 * thing.size.norm() + 0.25;
                                       });
      if (!is_free) continue;
      const double turn = random.Uniform() < 0.5 ? 0.0 : kPi;
      Eigen::Isometry3d X_WC = LevelPose(
          {at.x(), at.y(), 0.6}, turn + random.Uniform(-kMaxYaw, kMaxYaw));
      X_WC.rotate(Eigen::AngleAxisd(-kTilt, Eigen::Vector3d::UnitX()));
      X_WC.rotate(Eigen::AngleAxisd(random.Uniform(-kMaxRoll, kMaxRoll),
                                    Eigen::Vector3d::UnitZ()));
      frames.push_back(
          {corridor.name + " " + std::to_string(i++),
           GreyWithNoise(renderer.Render(rays, X_WC, X_WP).image, &random),
           {},
           X_WC.linear()});
    }
  }
  return frames;
}

std::vector<LineFrame> YorkFrames(int num) {
  std::vector<LineFrame> frames;
  const std::string folder = RealDataFolder("york_urban_vp");
  if (folder.empty()) return frames;
  std::vector<std::filesystem::path> files;
  for (const auto& entry :
       std::filesystem::directory_iterator(folder + "/images")) {
    files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  for (const auto& file : files) {
    if (static_cast<int>(frames.size()) == num) break;
    const cv::Mat1b image = cv::imread(file.string(), cv::IMREAD_GRAYSCALE);
    if (image.empty()) continue;
    frames.push_back({file.stem().string(), image, {}});
  }
  return frames;
}

std::vector<FoundSegment> FoundFrom(const LineSet& set) {
  std::vector<FoundSegment> found;
  for (const LineSegment& s : set.segments) {
    found.push_back({s.a, s.b, s.sigma_px});
  }
  return found;
}

LineScore ScoreSegments(const std::vector<LineFrame>& frames,
                        const std::vector<std::vector<FoundSegment>>& found) {
  std::vector<Segment> segments;
  std::vector<std::vector<Cover>> covers;  // Of each edge of 20 px.
  std::vector<double> edge_px;
  for (std::size_t f = 0; f < frames.size(); ++f) {
    std::vector<char> is_match(found[f].size(), 0);
    std::vector<char> is_near(found[f].size(), 0);
    std::vector<double> least(found[f].size(), 0.0);
    std::vector<double> strength;
    for (const FoundSegment& s : found[f]) {
      strength.push_back(StrengthOf(frames[f].image, s));
    }
    for (const TrueEdge& edge : frames[f].edges) {
      const double length = (edge.b - edge.a).norm();
      std::vector<Cover> of_edge;
      for (std::size_t i = 0; i < found[f].size(); ++i) {
        const FoundSegment& s = found[f][i];
        Match match;
        if (!Matches(s, edge, kMatchPx, kMatchRad, &match)) {
          is_near[i] |= Matches(s, edge, kNearPx, kNearRad, &match);
          continue;
        }
        // Two edges may lie side by side: the nearer one is meant.
        if (!is_match[i] || std::abs(match.offset) < least[i]) {
          least[i] = std::abs(match.offset);
        }
        is_match[i] = 1;
        of_edge.push_back({strength[i], match.begin, match.end});
      }
      if (length < kEdgePx) continue;
      covers.push_back(of_edge);
      edge_px.push_back(length);
    }
    for (std::size_t i = 0; i < found[f].size(); ++i) {
      if (is_match[i] == 0 && is_near[i] == 0 &&
          IsDrawn(frames[f].drawn, found[f][i])) {
        continue;
      }
      segments.push_back(
          {strength[i], is_match[i] != 0, least[i], found[f][i].sigma_px});
    }
  }
  std::sort(segments.begin(), segments.end(), [](const auto& a, const auto& b) {
    return a.strength > b.strength;
  });
  LineScore score;
  double num_matches = 0.0;
  for (std::size_t i = 0; i < segments.size(); ++i) {
    num_matches += segments[i].is_match;
    const double precision = num_matches / static_cast<double>(i + 1);
    const bool is_enough = precision >= kPrecision;
    if (!is_enough &&
        (score.precision >= kPrecision || precision < score.precision)) {
      continue;
    }
    score.precision = precision;
    score.threshold = segments[i].strength;
  }
  std::vector<double> offsets;
  std::vector<double> ratios;
  for (const Segment& s : segments) {
    if (!s.is_match || s.strength < score.threshold) continue;
    offsets.push_back(s.offset);
    if (s.sigma_px > 0.0) ratios.push_back(s.offset / s.sigma_px);
  }
  score.median_offset_px = Median(offsets);
  score.median_ratio = Median(ratios);
  double num_found = 0.0;
  for (std::size_t e = 0; e < covers.size(); ++e) {
    num_found += CoveredBy(covers[e], score.threshold) >= 0.5 * edge_px[e];
  }
  score.recall = num_found / std::max(1.0, static_cast<double>(covers.size()));
  return score;
}

}  // namespace waymark
