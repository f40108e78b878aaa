#include "tests/support/recorded_problems.h"

#include "estimation/base/check.h"
#include "estimation/base/random.h"
#include "estimation/batch/batch_refiner.h"
#include "estimation/batch/tick_track.h"
#include "estimation/geometry/angle.h"
#include "logs/import/brenner_lego_robot4.h"
#include "logs/import/censi_joint_calibration.h"
#include "logs/import/optiodom_diffdrive.h"
#include "tests/support/recorded_batch.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

namespace waymark {
namespace {

double MedianOf(std::vector<double> values) {
  WAYMARK_CHECK(!values.empty());
  const auto middle =
      values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// ---- motion capture --------------------------------------------------------

// Every fifth sample (4 Hz) is a fix: between them the robot moves some 5 cm,
// over which its wheels err by less than the motion capture does.
BatchLog MocapLog(const Recording& run) {
  BatchLog log = BatchLogFromRecording(run);
  std::vector<AbsoluteFix> thinned;
  for (std::size_t i = 0; i < log.fixes.size(); i += 5) {
    thinned.push_back(log.fixes[i]);
  }
  log.fixes = std::move(thinned);
  return log;
}

BatchOptions MocapOptions(const WheelParameters& nominal) {
  BatchOptions options;
  options.initial = nominal;
  options.scale_covariance = true;
  // Turning on the spot this robot shows a base of 201.4 mm, in curves 202.6.
  // The base's noise is what makes the two agree within their sigmas, about
  // 0.15 %: a choice made on these recordings.
  options.noise = {.wheel_variance = 1e-5, .base_variance = 3e-6};
  // The markers' frame was laid onto the robot by hand.
  BatchSensorOptions body;
  body.position = true;
  body.yaw = true;
  options.sensors = {body};
  return options;
}

BatchResult FitRuns(const std::vector<const Recording*>& runs) {
  std::vector<BatchLog> logs;
  for (const Recording* run : runs) logs.push_back(MocapLog(*run));
  return RefineBatch(logs, MocapOptions(runs[0]->nominal.parameters));
}

double ScoreRun(const Recording& run,
                const WheelParameters& wheels,
                const Pose2& X_RS) {
  const TruthSample& first = run.reference.samples.at(0);
  const Pose2 X_WS{first.p_WS.x(), first.p_WS.y(), first.heading.value()};
  return DeadReckoningRmse(run, wheels, X_WS * Inverse(X_RS), X_RS.position());
}

// ---- Censi -----------------------------------------------------------------

// Residuals of the laser's motion as the ticks predict it.
struct MotionResiduals {
  std::vector<double> position_m;
  std::vector<double> yaw_rad;
  // First and one past the last residual of each part, in the order added.
  std::vector<std::pair<std::size_t, std::size_t>> blocks;
  void Add(const Recording& part,
           const WheelParameters& wheels,
           const Pose2& X_RS) {
    blocks.emplace_back(yaw_rad.size(), yaw_rad.size() + part.motions.size());
    const TickTrack track(part.encoders);
    for (const RelativeMotion& motion : part.motions) {
      const Pose2 X_R0R1 = track
                               .Integrate(track.SecondsAt(motion.from),
                                          track.SecondsAt(motion.time),
                                          wheels,
                                          DriveNoise{},
                                          DriveIntegration::kArc)
                               .X_R0R1;
      const Pose2 X_S0S1 = Inverse(X_RS) * X_R0R1 * X_RS;
      position_m.push_back(
          (X_S0S1.position() - motion.X_S0S1.position()).norm());
      yaw_rad.push_back(
          std::abs(WrapAngle(X_S0S1.heading - motion.X_S0S1.heading)));
    }
  }
  [[nodiscard]] MotionMedians medians() const {
    return {MedianOf(position_m), MedianOf(yaw_rad)};
  }
};

// The order in which CrossValidateCensi adds blocks: subset `k` predicts the
// other two. Two blocks each hold the same tuples.
constexpr std::array<std::array<std::size_t, 2>, 3> kBlocksOfPart{
    {{2, 4}, {0, 5}, {1, 3}}};

MedianGap GapOf(
    const std::vector<double>& ours,
    const std::vector<double>& theirs,
    const std::vector<std::pair<std::size_t, std::size_t>>& blocks) {
  constexpr int kNumResamples = 400;  // Puts 10 beyond either end.
  Random random(1);
  std::vector<double> gaps;
  for (int i = 0; i < kNumResamples; ++i) {
    std::vector<double> a;
    std::vector<double> b;
    for (const auto& [one, two] : kBlocksOfPart) {
      const std::size_t size = blocks.at(one).second - blocks.at(one).first;
      WAYMARK_CHECK(size == blocks.at(two).second - blocks.at(two).first);
      for (std::size_t n = 0; n < size; ++n) {
        const std::size_t drawn = random.Index(size);
        for (const std::size_t block : {one, two}) {
          a.push_back(ours[blocks[block].first + drawn]);
          b.push_back(theirs[blocks[block].first + drawn]);
        }
      }
    }
    gaps.push_back(MedianOf(std::move(a)) / MedianOf(std::move(b)) - 1.0);
  }
  std::sort(gaps.begin(), gaps.end());
  return {MedianOf(ours) / MedianOf(theirs) - 1.0,
          gaps[kNumResamples / 40],
          gaps[kNumResamples - 1 - kNumResamples / 40]};
}

BatchResult FitCensi(const std::vector<const Recording*>& parts) {
  std::vector<BatchLog> logs;
  for (const Recording* part : parts) {
    logs.push_back(BatchLogFromRecording(*part));
  }
  BatchOptions options;
  options.initial = parts[0]->nominal.parameters;
  options.scale_covariance = true;
  // Intervals are put one after the other where some are missing: nothing ties
  // their ends, so a mean velocity has no whole-tick error.
  options.tick_sigma = 0.0;
  // Small steps of 0.8 s, whose wheel noise the laser's (about 2 mrad) must
  // not drown in: at this noise the variance factor is 1.
  options.noise = {.wheel_variance = 1e-7, .base_variance = 1e-9};
  BatchSensorOptions laser;
  laser.position = true;
  laser.yaw = true;
  laser.shared = false;
  laser.sigma_position_m = 0.05;
  options.sensors = {laser};
  return RefineBatch(logs, options);
}

}  // namespace

MocapReport CrossValidateMocap(const std::string& folder) {
  std::map<std::string, std::vector<Recording>> types;
  for (const std::string& path : FindOptiodomRuns(folder)) {
    const std::string inside = path.substr(folder.size() + 1);
    types[inside.substr(0, inside.find('/'))].push_back(ReadOptiodomRun(path));
  }
  MocapReport report;
  for (std::size_t half = 0; half < 2; ++half) {
    std::vector<const Recording*> train;
    for (const auto& [name, runs] : types) {
      for (std::size_t i = half; i < runs.size(); i += 2) {
        train.push_back(&runs[i]);
      }
    }
    report.halves[half] = FitRuns(train);
  }
  std::map<std::string, double> bases;
  for (const auto& [name, runs] : types) {
    std::vector<double> nominal;
    std::vector<double> fitted;
    std::vector<double> wheels_only;
    std::vector<const Recording*> all;
    for (std::size_t i = 0; i < runs.size(); ++i) {
      const BatchResult& other = report.halves[1 - i % 2];
      nominal.push_back(ScoreRun(runs[i], runs[i].nominal.parameters, {}));
      fitted.push_back(
          ScoreRun(runs[i], other.parameters, other.sensors.at(0).X_RS));
      wheels_only.push_back(ScoreRun(runs[i], other.parameters, {}));
      all.push_back(&runs[i]);
    }
    MocapTypeReport type;
    type.name = name;
    type.num_runs = static_cast<int>(runs.size());
    type.nominal_m = MedianOf(nominal);
    type.fitted_m = MedianOf(fitted);
    type.wheels_only_m = MedianOf(wheels_only);
    type.alone = FitRuns(all);
    bases[name] = type.alone.parameters.wheel_base;
    report.num_runs += type.num_runs;
    report.types.push_back(std::move(type));
  }
  report.base_gap = bases.at("circular") / bases.at("square") - 1.0;
  return report;
}

CensiReport CrossValidateCensi(const std::string& folder) {
  const std::array<std::string, 2> names{"lstraight", "l90"};
  std::array<std::array<Recording, 3>, 2> parts;
  std::array<std::array<CensiResult, 3>, 2> stored;
  for (std::size_t m = 0; m < 2; ++m) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::string stem =
          folder + "/" + names[m] + "_" + std::to_string(k);
      parts[m][k] = ReadCensiTuples(stem + ".tuple");
      stored[m][k] = ReadCensiResult(stem + "_results.json");
      // Theirs are per radian of wheel turn, our ticks are a part of one.
      stored[m][k].wheels.k_right *= kCensiResolution;
      stored[m][k].wheels.k_left *= kCensiResolution;
    }
  }
  std::array<MotionResiduals, 2> ours;
  std::array<MotionResiduals, 2> authors;
  for (std::size_t k = 0; k < 3; ++k) {
    const BatchResult fit = FitCensi({&parts[0][k], &parts[1][k]});
    for (std::size_t m = 0; m < 2; ++m) {
      for (std::size_t other = 0; other < 3; ++other) {
        if (other == k) continue;
        ours[m].Add(parts[m][other], fit.parameters, fit.sensors.at(m).X_RS);
        authors[m].Add(parts[m][other], stored[m][k].wheels, stored[m][k].X_RS);
      }
    }
  }
  CensiReport report;
  std::array<double, 2> axles{};
  std::array<double, 2> their_axles{};
  for (std::size_t m = 0; m < 2; ++m) {
    CensiMountingReport mounting;
    mounting.name = names[m];
    mounting.num_held_out = static_cast<int>(ours[m].yaw_rad.size());
    mounting.ours = ours[m].medians();
    mounting.authors = authors[m].medians();
    mounting.position_gap =
        GapOf(ours[m].position_m, authors[m].position_m, ours[m].blocks);
    mounting.yaw_gap =
        GapOf(ours[m].yaw_rad, authors[m].yaw_rad, ours[m].blocks);
    report.mountings.push_back(mounting);
    axles[m] = FitCensi({&parts[m][0], &parts[m][1], &parts[m][2]})
                   .parameters.wheel_base;
    their_axles[m] = ReadCensiResult(folder + "/" + names[m] + "_results.json")
                         .wheels.wheel_base;
  }
  // Whole recordings: one mounting each.
  const Recording straight = ReadCensiTuples(folder + "/lstraight.tuple");
  const Recording turned = ReadCensiTuples(folder + "/l90.tuple");
  report.joint = FitCensi({&straight, &turned});
  const auto spread = [](const std::array<double, 2>& a) {
    return std::max(a[0], a[1]) / std::min(a[0], a[1]) - 1.0;
  };
  report.axle_spread = spread(axles);
  report.authors_axle_spread = spread(their_axles);
  return report;
}

LegoReport FitLego(const std::string& folder) {
  const Recording run = ReadBrennerLegoRobot4(folder);
  const BatchLog log = BatchLogFromRecording(run);
  BatchOptions options;
  options.initial = run.nominal.parameters;
  options.scale_covariance = true;
  options.keep_trajectory = true;
  options.noise = {.wheel_variance = 1e-5, .base_variance = 1e-8};
  BatchSensorOptions camera;
  camera.time_offset = true;
  options.sensors = {camera};
  LegoReport report;
  report.result = RefineBatch({&log, 1}, options);
  const double offset = report.result.sensors.at(0).time_offset_s;
  WAYMARK_CHECK(run.start.has_value());
  report.nominal_m = DeadReckoningRmse(
      run, run.nominal.parameters, run.start->X_WR, run.reference.p_RS);
  report.fitted_m =
      DeadReckoningRmse(run,
                        report.result.parameters,
                        report.result.trajectories.at(0).front().X_WR,
                        run.reference.p_RS,
                        offset);
  return report;
}

}  // namespace waymark
