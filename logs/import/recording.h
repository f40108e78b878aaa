// One recording by others, as values: what an importer makes of its files,
// without messages.
#pragma once

#include "estimation/base/time.h"
#include "estimation/filter/estimate_types.h"
#include "estimation/filter/measurement_types.h"
#include "logs/evaluation/trajectory_types.h"

#include <Eigen/Core>

#include <optional>
#include <string>
#include <vector>

namespace waymark {

// Recordings whose clock starts at 0 start here, so that no stamp is 0.
inline constexpr Time kRecordingEpoch = TimeFromMicroseconds(1'000'000'000);

// What somebody else's instrument says about where the robot was.
struct Reference {
  std::string source;                // The instrument: "overhead camera".
  std::vector<TruthSample> samples;  // In order of time.
  Eigen::Vector2d p_RS = Eigen::Vector2d::Zero();  // Of every sample, m.
  // Standard deviation of one sample: m, m, rad. From the data set where it
  // states one, else an assumption that `notes` names.
  Eigen::Vector3d sigma = Eigen::Vector3d::Ones();
};

// One turn of a laser with evenly spaced beams.
struct RangeScan {
  Time time;
  double first_angle = 0.0;   // Of the first beam in the sensor, rad.
  double step = 0.0;          // Between beams, rad.
  std::vector<float> ranges;  // m; 0 where there was no echo.
};

struct Recording {
  std::string format;  // "brenner_lego_robot4"
  std::string name;    // Names the run, fit for a file name.

  std::vector<EncoderReading> encoders;  // Times strictly increase.
  // Made from wheel velocities, not counted. The resolution is what one tick
  // stands for, in words: "1e-06 rad".
  bool has_virtual_ticks = false;
  std::string virtual_resolution;

  // What the authors state about their wheels; source "nominal".
  OdometryParameters nominal;
  std::optional<InitialPose> start;  // Where the recording states one.
  Reference reference;
  std::vector<RelativeMotion> motions;  // `from` and `time` are encoder times.
  std::vector<RangeScan> scans;

  // What a reader should know: what was merged, left out or assumed.
  std::vector<std::string> notes;
};

// Nominal parameters with independent standard deviations.
[[nodiscard]] OdometryParameters NominalParameters(
    Time time, const WheelParameters& parameters, const Eigen::Vector3d& sigma);

// A stated start with independent standard deviations (m, m, rad).
[[nodiscard]] InitialPose StatedStart(Time time,
                                      const Pose2& X_WR,
                                      const Eigen::Vector3d& sigma);

// Moves the reference's samples `delay_s` back in time, where its clock or its
// processing is late, and says so in the notes.
void SetReferenceBack(double delay_s, Recording* recording);

// Length of the polygon through the samples, m.
[[nodiscard]] double PathLength(const Reference& reference);

// Travel of the robot's middle by the nominal parameters, m.
[[nodiscard]] double WheelPathLength(const Recording& recording);

}  // namespace waymark
