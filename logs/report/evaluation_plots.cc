#include "logs/report/evaluation_plots.h"

#include "estimation/geometry/angle.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <utility>

namespace waymark {
namespace {

// Estimates with a colour of their own, back to front.
struct Shown {
  const char* id;
  const char* role;
  const char* label;
};
constexpr std::array kShown = {
    Shown{"raw", "raw", "raw"},
    Shown{"dead_reckoning_batch", "batch", "dead reckoning, batch parameters"},
    Shown{"online", "online", "online (POSE)"},
    Shown{"settled", "settled", "settled (POSE_SETTLED)"}};

constexpr double kBreak = std::numeric_limits<double>::quiet_NaN();
constexpr double kAnyStep = std::numeric_limits<double>::infinity();
// A path is interrupted where nothing was published for so long.
constexpr double kGapS = 2.0;

// The estimate to show as raw: as published, else integrated offline.
const EstimateEvaluation* Find(const LogEvaluation& evaluation,
                               const Shown& shown) {
  const EstimateEvaluation* estimate = evaluation.Find(shown.id);
  const bool is_missing = estimate == nullptr || !estimate->missing.empty();
  if (is_missing && std::string_view(shown.id) == "raw") {
    return evaluation.Find("raw_nominal");
  }
  return estimate;
}

// Zero of all time axes.
Time StartOf(const LogEvaluation& evaluation) {
  const LogRecording& r = evaluation.recording;
  std::optional<Time> start;
  const auto take = [&](Time t) { start = start ? std::min(*start, t) : t; };
  if (!r.readings.empty()) take(r.readings.front().time);
  if (!r.truth.empty()) take(r.truth.front().time);
  for (const auto& estimate : evaluation.estimates) {
    if (!estimate.path.empty()) take(estimate.path.front().time);
  }
  return start.value_or(Time());
}

template <typename Point>
std::vector<PlotPoint> PathPoints(const std::vector<Point>& path,
                                  auto position) {
  std::vector<PlotPoint> points;
  for (std::size_t i = 0; i < path.size(); ++i) {
    if (i > 0 && Seconds(path[i].time - path[i - 1].time) > kGapS) {
      points.push_back({kBreak, kBreak});
    }
    const Eigen::Vector2d p = position(path[i]);
    points.push_back({p.x(), p.y()});
  }
  return points;
}

std::vector<PlotPoint> OverTime(Time start,
                                const std::vector<Time>& times,
                                const std::vector<double>& values,
                                double scale,
                                double max_step = kAnyStep) {
  std::vector<PlotPoint> points;
  for (std::size_t i = 0; i < times.size(); ++i) {
    const bool is_gap = i > 0 && Seconds(times[i] - times[i - 1]) > kGapS;
    // An angle that wraps leaves the frame and comes back.
    if (is_gap || (i > 0 && std::abs(values[i] - values[i - 1]) > max_step)) {
      points.push_back({kBreak, kBreak});
    }
    points.push_back({Seconds(times[i] - start), scale * values[i]});
  }
  return points;
}

// One line per shown estimate of which `points_of` has points.
void AddEstimates(
    const LogEvaluation& evaluation,
    const std::function<std::vector<PlotPoint>(const EstimateEvaluation&)>&
        points_of,
    Plot* plot) {
  for (const Shown& shown : kShown) {
    const EstimateEvaluation* estimate = Find(evaluation, shown);
    if (estimate == nullptr) continue;
    std::vector<PlotPoint> points = points_of(*estimate);
    if (points.empty()) continue;
    plot->series.push_back({shown.label,
                            shown.role,
                            PlotSeries::Style::kLine,
                            std::move(points),
                            {}});
  }
}

}  // namespace

Plot TrajectoryPlot(const LogEvaluation& evaluation) {
  const LogRecording& recording = evaluation.recording;
  Plot plot;
  plot.title = "Path";
  plot.x_label = "x, m";
  plot.y_label = "y, m";
  plot.has_equal_aspect = true;
  plot.height = 420;
  // Where the reference's point is on the robot, so that paths coincide.
  const Eigen::Vector2d p_RS = recording.truth.empty()
                                   ? Eigen::Vector2d::Zero().eval()
                                   : recording.truth.front().p_RS;
  plot.series.push_back(
      {"reference",
       "truth",
       PlotSeries::Style::kLine,
       PathPoints(recording.truth, [](const TruthSample& s) { return s.p_WS; }),
       {}});
  std::vector<PlotPoint> fixes;
  for (const AbsoluteFix& fix : recording.fixes) {
    if (!fix.has[0] || !fix.has[1]) continue;
    const Eigen::Vector2d p = fix.X_WF * Eigen::Vector2d(fix.value.head<2>());
    fixes.push_back({p.x(), p.y()});
  }
  plot.series.push_back(
      {"position fixes", "fix", PlotSeries::Style::kDots, fixes, {}});
  AddEstimates(
      evaluation,
      [&](const EstimateEvaluation& estimate) {
        return PathPoints(estimate.path, [&](const EstimatedPose& pose) {
          return (pose.X_WR * p_RS).eval();
        });
      },
      &plot);
  return plot;
}

Plot PositionErrorPlot(const LogEvaluation& evaluation) {
  Plot plot;
  plot.title = "Position error";
  plot.x_label = "time, s";
  plot.y_label = "distance, mm";
  plot.height = 420;  // As the path beside it.
  plot.is_log_y = true;
  plot.y_floor = 0.1;  // mm: below what any reference here resolves.
  constexpr double kMillimetres = 1e3;
  AddEstimates(
      evaluation,
      [start = StartOf(evaluation)](const EstimateEvaluation& estimate) {
        if (!estimate.absolute) return std::vector<PlotPoint>();
        const AbsoluteError& error = *estimate.absolute;
        return OverTime(start, error.times, error.position, kMillimetres);
      },
      &plot);
  return plot;
}

Plot CorridorPlot(const LogEvaluation& evaluation) {
  Plot plot;
  plot.title = "Across the corridor";
  plot.x_label = "time, s";
  plot.y_label = "left of the middle, m";
  const Time start = StartOf(evaluation);
  using Style = PlotSeries::Style;
  PlotSeries truth{"reference", "truth", Style::kLine, {}, {}};
  PlotSeries seen{"seen", "raw", Style::kDots, {}, {}};
  PlotSeries refused{"seen, not believed", "batch", Style::kDots, {}, {}};
  PlotSeries fused{"POSE", "online", Style::kLine, {}, {}};
  for (const CorridorSight& sight : evaluation.corridor->sights) {
    const double t = Seconds(sight.time - start);
    const auto point = [&](const std::optional<double>& y) {
      return y ? PlotPoint{t, *y} : PlotPoint{kBreak, kBreak};
    };
    truth.points.push_back(point(sight.true_y));
    fused.points.push_back(point(sight.fused_y));
    if (!sight.y) continue;
    const bool is_accepted = sight.status == CorridorStatus::kAccepted;
    (is_accepted ? seen : refused).points.push_back({t, *sight.y});
  }
  for (PlotSeries* series : {&seen, &refused, &truth, &fused}) {
    if (!series->points.empty()) plot.series.push_back(std::move(*series));
  }
  return plot;
}

Plot HeadingErrorPlot(const LogEvaluation& evaluation) {
  Plot plot;
  plot.title = "Heading error";
  plot.x_label = "time, s";
  plot.y_label = "estimate - reference, °";
  AddEstimates(
      evaluation,
      [start = StartOf(evaluation)](const EstimateEvaluation& estimate) {
        if (!estimate.absolute) return std::vector<PlotPoint>();
        const AbsoluteError& error = *estimate.absolute;
        return OverTime(start,
                        error.heading_times,
                        error.heading,
                        DegreesFromRadians(1.0),
                        kPi);
      },
      &plot);
  return plot;
}

Plot NeesPlot(const LogEvaluation& evaluation) {
  Plot plot;
  plot.title = "Consistency (NEES of the position)";
  plot.x_label = "time, s";
  plot.y_label = "NEES, no unit";
  plot.is_log_y = true;
  plot.y_floor = 1e-3;
  AddEstimates(
      evaluation,
      [&plot, start = StartOf(evaluation)](const EstimateEvaluation& estimate) {
        if (!estimate.nees_position) return std::vector<PlotPoint>();
        const Nees& nees = *estimate.nees_position;
        plot.bands = {{nees.band.low, nees.band.high, "95 % band"}};
        return OverTime(start, nees.times, nees.values, 1.0);
      },
      &plot);
  return plot;
}

std::vector<Plot> ParameterPlots(const LogEvaluation& evaluation) {
  struct Quantity {
    const char* title;
    const char* label;
    double scale;
  };
  constexpr std::array kQuantities = {
      Quantity{"Right wheel", "k_right, µm per tick", 1e6},
      Quantity{"Left wheel", "k_left, µm per tick", 1e6},
      Quantity{"Wheel base", "B, mm", 1e3}};
  const Time start = StartOf(evaluation);
  double end_s = 0.0;
  for (const auto& parameters : evaluation.parameters) {
    for (const auto& sample : parameters.samples) {
      end_s = std::max(end_s, Seconds(sample.time - start));
    }
  }
  std::vector<Plot> plots;
  for (int k = 0; k < 3; ++k) {
    const Quantity& quantity = kQuantities[static_cast<std::size_t>(k)];
    Plot plot;
    plot.title = quantity.title;
    plot.x_label = "time, s";
    plot.y_label = quantity.label;
    plot.height = 280;
    for (const auto& parameters : evaluation.parameters) {
      const bool is_nominal = parameters.source == "nominal";
      const bool is_fixed = is_nominal || parameters.source == "truth";
      PlotSeries series;
      series.label = parameters.source + (is_fixed ? "" : " ± 2 sigma");
      series.role = is_nominal ? "raw" : parameters.source;
      series.style =
          is_nominal ? PlotSeries::Style::kDashed : PlotSeries::Style::kLine;
      for (const ParameterSample& sample : parameters.samples) {
        series.points.push_back(
            {Seconds(sample.time - start),
             quantity.scale * sample.parameters.vector()(k)});
        series.half_width.push_back(
            is_fixed ? 0.0
                     : 2.0 * quantity.scale *
                           std::sqrt(std::max(0.0, sample.covariance(k, k))));
      }
      // A single value holds all along; the last of several to the end.
      if (series.points.size() == 1 && series.points[0].x > 0.0) {
        series.points.insert(series.points.begin(), {0.0, series.points[0].y});
        series.half_width.insert(series.half_width.begin(),
                                 series.half_width[0]);
      }
      series.points.push_back({end_s, series.points.back().y});
      series.half_width.push_back(series.half_width.back());
      if (is_fixed) series.half_width.clear();
      plot.series.push_back(std::move(series));
    }
    plots.push_back(std::move(plot));
  }
  return plots;
}

}  // namespace waymark
