#include "processes/corridor_tracker/corridor_tracker_config.h"

#include "processes/convert/camera_file.h"
#include "processes/convert/corridor_file.h"
#include "processes/support/channels.h"

#include <stdexcept>

namespace waymark {

void CorridorTrackerConfig::Describe(Describer& d) {
  constexpr Range kShare{0.0, 1.0};
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
        d.Number("floor_missing",
                 &tracker.pose.evidence.floor_missing,
                 kShare,
                 "Share of the floor's edges and skirting boards in view on "
                 "which no line is found");
        d.Number("ceiling_missing",
                 &tracker.pose.evidence.ceiling_missing,
                 kShare,
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
}

void CorridorTrackerConfig::Check() const {
  if (!IsCameraName(camera)) {
    throw std::invalid_argument("camera = " + camera +
                                " must consist of A-Z, 0-9 and _");
  }
  if (corridors.empty()) {
    throw std::invalid_argument("corridors: must name a file");
  }
  tracker.Check();
}

void CorridorTrackerConfig::CheckFiles() const {
  (void)LoadCorridorFile(FindCorridorFile(corridors));
  if (!calibration.empty()) (void)LoadCameraFile(FindCameraFile(calibration));
}

}  // namespace waymark
