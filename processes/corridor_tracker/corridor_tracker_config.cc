#include "processes/corridor_tracker/corridor_tracker_config.h"

#include "estimation/base/input_error.h"
#include "processes/convert/camera_file.h"
#include "processes/convert/corridor_file.h"
#include "processes/support/channels.h"

#include <stdexcept>

namespace waymark {

void CorridorTrackerConfig::Describe(Describer& d) {
  constexpr Range kShare{0.0, 1.0};
  // Certainty either way would leave nothing to weigh.
  constexpr Range kUncertain{1e-6, 1.0 - 1e-6};
  d.Text("camera", &camera, "As in IMAGE_<camera>: A-Z, 0-9 and _");
  d.Text("calibration",
         &calibration,
         "Calibration file of the camera, or one that comes with Waymark; "
         "empty: as CAMERA_INFO_<camera> says");
  d.Text(
      "corridors", &corridors, "Corridor file, or one that comes with Waymark");
  d.Choice<CorridorMethod>(
      "method",
      &tracker.method,
      {{"joint", CorridorMethod::kJoint}, {"paper", CorridorMethod::kPaper}},
      "Heading and position together, or one after the "
      "other with constant errors, as published");
  d.Group(
      "lines",
      [&] {
        d.Choice<LineScheme>("scheme",
                             &tracker.lines.scheme,
                             {{"segmented_hough", LineScheme::kSegmentedHough},
                              {"edge_chains", LineScheme::kEdgeChains}},
                             "As published, or edges followed along their "
                             "gradient");
        d.Choice<HoughForm>(
            "hough",
            &tracker.lines.hough.form,
            {{"words", HoughForm::kWords}, {"tables", HoughForm::kLiteral}},
            "Of segmented_hough: 8 x 8 tiles as words, or 10 x "
            "10 with look-up tables, as published");
        d.Choice<EdgeSuppression>(
            "suppression",
            &tracker.lines.edges.suppression,
            {{"two_axes", EdgeSuppression::kTwoAxes},
             {"four_directions", EdgeSuppression::kFourDirections}},
            "Edge pixels are compared with neighbours along two axes, as "
            "published, or along four directions");
        d.Number("model_px",
                 &tracker.model_px,
                 {0.0, 100.0},
                 "Error of a straight wall, added to a line's own, 1 sigma");
        d.Number("model_rad",
                 &tracker.model_rad,
                 {0.0, 1.0},
                 "and of its direction");
      },
      "Of the image");
  d.Group(
      "heading",
      [&] {
        d.Number("min_evidence",
                 &tracker.heading.min_evidence,
                 kNotNegative,
                 "Logarithm of the likelihood over that of lines at random");
        d.Degrees("max_prior_deg",
                  &tracker.max_prior_rad,
                  {0.1, 180.0},
                  "A heading known worse before does not choose between both "
                  "directions");
      },
      "In the corridor");
  d.Group(
      "position",
      [&] {
        d.Number("min_evidence",
                 &tracker.pose.min_evidence,
                 kNotNegative,
                 "As of the heading");
        d.Number("min_margin",
                 &tracker.pose.min_margin,
                 kNotNegative,
                 "by which it stands out from any other position");
        d.Number("min_margin_one_wall",
                 &tracker.pose.min_margin_one_wall,
                 kNotNegative,
                 "The same where the edges of one wall alone are seen");
        d.Number("max_rms_one_wall_px",
                 &tracker.pose.max_rms_one_wall_px,
                 kPositive,
                 "and how far those may lie from where they should be");
        d.Number("floor_missing",
                 &tracker.pose.evidence.floor_missing,
                 kUncertain,
                 "Share of the floor's edges and skirting boards in view on "
                 "which no line is found");
        d.Number("ceiling_missing",
                 &tracker.pose.evidence.ceiling_missing,
                 kUncertain,
                 "and of the ceiling's, often as bright as the wall");
        d.Number("reach_m",
                 &tracker.pose.evidence.reach_m,
                 kPositive,
                 "So far away edges are looked at");
        d.Number("floor_m",
                 &tracker.pose.floor_m,
                 kPositive,
                 "Error that no number of lines takes away, 1 sigma");
        d.Number("floor_rad",
                 &tracker.pose.floor_rad,
                 kPositive,
                 "and of the heading");
        d.Number("end_m",
                 &tracker.end_m,
                 kNotNegative,
                 "So near to its end ahead the corridor counts as ending");
      },
      "Across the corridor");
  d.Group(
      "gate",
      [&] {
        d.Number(
            "min_regular",
            &tracker.gate.min_regular,
            kShare,
            "Accepted where the probability of a regular answer is higher");
        d.Number("prior_regular",
                 &tracker.gate.prior_regular,
                 kShare,
                 "Share of regular answers");
        d.Number("faulty_position_sigma",
                 &tracker.gate.faulty_position_sigma,
                 kPositive,
                 "Error of the others, m");
        d.Number("faulty_heading_sigma",
                 &tracker.gate.faulty_heading_sigma,
                 kPositive,
                 "rad");
      },
      "Regular, or faulty, given what was believed before");
  d.Group(
      "paper", [&] { DescribePaper(d); }, "Of method: paper");
}

void CorridorTrackerConfig::DescribePaper(Describer& d) {
  PaperPoseOptions& paper = tracker.paper;
  d.Integer("points_kept",
            &paper_points_kept,
            1,
            10'000,
            "Intersections left by the removal of the furthest");
  d.Integer("candidates_kept",
            &paper_candidates_kept,
            1,
            10'000,
            "Lateral candidates left by it");
  d.Flag("needs_both_walls",
         &paper.lateral.needs_both_walls,
         "Lines of one wall alone give no position");
  d.Number("sigma_m", &paper.sigma_m, kPositive, "Error of every position");
  d.Number("sigma_rad",
           &paper.sigma_rad,
           kPositive,
           "and of every heading, 1 sigma");
}

void CorridorTrackerConfig::Check() const {
  if (!IsCameraName(camera)) {
    throw std::invalid_argument("camera = " + camera +
                                " must consist of A-Z, 0-9 and _");
  }
  if (corridors.empty()) {
    throw std::invalid_argument(
        "corridors: must name a corridor file, or one that comes with Waymark");
  }
  Options().Check();
}

CorridorTrackerOptions CorridorTrackerConfig::Options() const {
  CorridorTrackerOptions options = tracker;
  options.paper.vanishing.num_kept = static_cast<int>(paper_points_kept);
  options.paper.lateral.num_kept = static_cast<int>(paper_candidates_kept);
  return options;
}

void CorridorTrackerConfig::CheckFiles() const {
  (void)LoadCorridorFile(FindCorridorFile(corridors));
  if (calibration.empty()) return;
  const std::string file = FindCameraFile(calibration);
  try {
    CheckSeesAhead(LoadCameraFile(file).model);
  } catch (const std::invalid_argument& error) {
    throw InputError(file + ": " + error.what());
  }
}

}  // namespace waymark
