// Methods to a corridor's pose, as benchmarks vary them, on rendered frames.
#pragma once

#include "estimation/corridor/corridor_tracker.h"
#include "tests/bench/corridor_pose_frames.h"

#include <functional>
#include <string>
#include <vector>

namespace waymark {

// Frames of one world, as seen without the lens's distortion.
struct Views {
  std::string world;
  CorridorView view;
  std::vector<CorridorPoseFrame> frames;
};

// Of all worlds; one thread from here on.
[[nodiscard]] std::vector<Views> RenderViews(int num_per_world);

// What an answer was made from.
struct Given {
  const CorridorView& view;
  const CorridorGeometry& corridor;
  std::vector<SeenLine> lines;
  CorridorPrior prior;
};

// A method, and what of its answer is made otherwise: heading, y, covariance.
struct Method {
  std::string name;
  CorridorTrackerOptions options;
  std::function<void(const Given&, CorridorEstimate*)> amend;
};

// From the edge image to the errors as published.
[[nodiscard]] CorridorTrackerOptions PublishedOptions();

[[nodiscard]] CorridorEstimate Answer(const Method& method,
                                      const Views& views,
                                      const CorridorGeometry& corridor,
                                      const LineSet& lines,
                                      const CorridorPrior& prior);

// Extracts lines and answers, frame by frame.
void AddTo(const Method& method, const Views& views, PoseScore* score);

// ---- figures of a score ----------------------------------------------------

using PoseFigure = std::function<double(const PoseScore&)>;
[[nodiscard]] PoseFigure PositionAt(double share);        // Quantile, cm.
[[nodiscard]] PoseFigure HeadingAt(double share);         // Degrees.
[[nodiscard]] double Accepted(const PoseScore& score);    // %.
[[nodiscard]] double BeyondFour(const PoseScore& score);  // Sigmas, %.
[[nodiscard]] double MedianTime(const PoseScore& score);  // ms.

}  // namespace waymark
