#include "tests/bench/corridor_methods.h"

#include "estimation/camera/image_remap.h"
#include "estimation/geometry/angle.h"
#include "tests/bench/measure.h"

#include <opencv2/core.hpp>

#include <utility>
#include <variant>

namespace waymark {

std::vector<Views> RenderViews(int num_per_world) {
  cv::setNumThreads(1);
  std::vector<Views> all;
  for (const CorridorWorld& world : kCorridorWorlds) {
    CorridorPoseFrames source(world.name, 1);
    const CameraDescription& camera = source.camera();
    const Intrinsics intrinsics =
        std::get<PerspectiveCamera>(camera.model).intrinsics();
    const ImageRemap remap({PerspectiveCamera(intrinsics), camera.size},
                           {camera.model, camera.size},
                           Eigen::Matrix3d::Identity());
    Views views{world.name, {intrinsics, camera.size, camera.X_RC}, {}};
    for (int i = 0; i < num_per_world; ++i) {
      CorridorPoseFrame frame = source.Next();
      frame.image = cv::Mat1b(remap.Apply(frame.image));
      views.frames.push_back(std::move(frame));
    }
    all.push_back(std::move(views));
  }
  return all;
}

CorridorTrackerOptions PublishedOptions() {
  CorridorTrackerOptions options;
  options.method = CorridorMethod::kPaper;
  options.lines.edges.suppression = EdgeSuppression::kTwoAxes;
  options.lines.scheme = LineScheme::kSegmentedHough;
  options.lines.hough.form = HoughForm::kLiteral;
  return options;
}

CorridorEstimate Answer(const Method& method,
                        const Views& views,
                        const CorridorGeometry& corridor,
                        const LineSet& lines,
                        const CorridorPrior& prior) {
  CorridorEstimate found =
      EstimateCorridor(views.view, lines, corridor, prior, method.options);
  if (!method.amend || !found.heading) return found;
  Given given{views.view, corridor, {}, prior};
  for (const LineSegment& segment : lines.segments) {
    given.lines.push_back(
        SeenLineOf(segment, method.options.model_px, method.options.model_rad));
  }
  method.amend(given, &found);
  found.p_regular = RegularProbabilityOf(found, prior, method.options.gate);
  found.status = CorridorStatus::kNoPosition;
  if (found.y) {
    found.status = found.p_regular > method.options.gate.min_regular
                       ? CorridorStatus::kAccepted
                       : CorridorStatus::kFaulty;
  }
  return found;
}

void AddTo(const Method& method, const Views& views, PoseScore* score) {
  LineExtractor extractor(method.options.lines);
  for (const CorridorPoseFrame& frame : views.frames) {
    const double begin = CpuSeconds();
    const CorridorEstimate found = Answer(method,
                                          views,
                                          frame.corridor,
                                          extractor.Extract(frame.image),
                                          frame.prior);
    score->Add(found, frame.X_LR, 1e3 * (CpuSeconds() - begin));
  }
}

PoseFigure PositionAt(double share) {
  return [share](const PoseScore& score) {
    return 100.0 * Quantile(score.y_errors, share);
  };
}

PoseFigure HeadingAt(double share) {
  return [share](const PoseScore& score) {
    return DegreesFromRadians(Quantile(score.heading_errors, share));
  };
}

double Accepted(const PoseScore& score) {
  return score.AcceptedPercent();
}
double BeyondFour(const PoseScore& score) {
  return score.PercentBeyond(4.0);
}
double MedianTime(const PoseScore& score) {
  return Quantile(score.times_ms, 0.5);
}

}  // namespace waymark
