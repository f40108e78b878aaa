// Images with known lines, and how well segments match them.
#pragma once

#include "estimation/lines/line_direction.h"
#include "estimation/lines/line_types.h"

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

#include <string>
#include <vector>

namespace waymark {

struct TrueEdge {
  Eigen::Vector2d a;
  Eigen::Vector2d b;
};

struct LineFrame {
  std::string name;
  cv::Mat1b image;
  std::vector<TrueEdge> edges;  // All that are seen; none of photographs.
  // Of the camera in the world, where it is known.
  Eigen::Matrix3d R_WC = Eigen::Matrix3d::Identity();
  // 255 where lines may be drawn that are no edges of the scene: tiles, bricks,
  // pictures. Empty: nowhere.
  cv::Mat1b drawn{};
};

enum class FrameLooks { kPlain, kDrawn };

// 640 x 480 views along two corridors, of a pinhole camera of f = 400 px with
// noise of 1.5 grey levels, and the exact lines in them. Surfaces are plain, or
// as they are, with all that is drawn on them.
[[nodiscard]] std::vector<LineFrame> RenderedLineFrames(
    int num_per_world, FrameLooks looks = FrameLooks::kPlain);
// Views along the simulator's four corridors, whose axes are W's x, with all
// that is drawn on their walls: robots between the walls, turned by up to 25
// degrees, their cameras 5 degrees down and rolled by up to 3. No edges.
inline constexpr PinholeView kCorridorView{457.0, 457.0, 319.5, 239.5};
[[nodiscard]] std::vector<LineFrame> CorridorFrames(int num_per_world);
// The York Urban photographs; none where the recordings are not there.
[[nodiscard]] std::vector<LineFrame> YorkFrames(int num);

// A found segment, whoever found it.
struct FoundSegment {
  Eigen::Vector2d a;
  Eigen::Vector2d b;
  double sigma_px = 0.0;
};
[[nodiscard]] std::vector<FoundSegment> FoundFrom(const LineSet& set);

struct LineScore {
  double recall = 0.0;            // Of edges of 20 px or more.
  double precision = 0.0;         // Of segments.
  double threshold = 0.0;         // Of what can be seen of a segment.
  double median_offset_px = 0.0;  // Of matched segments, at their middle.
  double median_ratio = 0.0;  // Of |offset| to sigma_px; 0.67 if both agree.
};

// A segment matches an edge where it turns from it by 1 degree at most, both
// its ends lie within 1.5 px of its line and half of it beside the edge. An
// edge is found where its matches cover half of it. Detectors state no common
// measure of trust, so all are swept over the same one, taken from the image:
// the mean step of the grey value across the segment, times the root of its
// length. Of all thresholds the lowest is taken at which 9 of 10 segments
// match; without one, the most precise. What lies on drawn surfaces and farther
// than 6 px or 5 degrees from all edges is neither right nor wrong: nobody
// knows which of the lines that are drawn there it is. `found`: of each frame.
[[nodiscard]] LineScore ScoreSegments(
    const std::vector<LineFrame>& frames,
    const std::vector<std::vector<FoundSegment>>& found);

}  // namespace waymark
