#include "logs/import/brenner_lego_robot4.h"

#include "estimation/geometry/angle.h"
#include "logs/import/text_records.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>
#include <vector>

namespace waymark {
namespace {

constexpr std::string_view kMotorsSuffix = "_motors.txt";
// The scanner, which the overhead camera sees, ahead of the axle, m.
constexpr double kScannerAhead = 0.030;
// Beams of a Hokuyo URG-04LX are 1/1024 of a turn apart; beam 330 of 660 looks
// ahead but for a mounting angle of -4 degrees that the course states.
constexpr double kBeamStep = 2.0 * kPi / 1024.0;
constexpr double kMountingAngle = -4.0 * kPi / 180.0;
constexpr int kForwardBeam = 330;

// "folder/robot4" for "folder/robot4_motors.txt".
std::string FindPrefix(const std::string& folder) {
  std::vector<std::string> prefixes;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(folder, error)) {
    const std::string path = entry.path().string();
    if (path.ends_with(kMotorsSuffix)) {
      prefixes.push_back(path.substr(0, path.size() - kMotorsSuffix.size()));
    }
  }
  if (error) throw InputError(folder + ": " + error.message());
  if (prefixes.size() != 1) {
    throw InputError(folder + ": " + std::to_string(prefixes.size()) +
                     " files *_motors.txt, 1 needed");
  }
  return prefixes.front();
}

class StampReader {
 public:
  // Column 2, milliseconds; throws where time goes backwards.
  Time Read(const TextRecords& records) {
    const std::int64_t ms = records.Integer(2);
    // A year: beyond that the column is no run's clock.
    constexpr std::int64_t kMaxMs = 366ll * 86'400'000ll;
    if (ms < 0 || ms > kMaxMs) {
      records.FailColumn(2, std::to_string(ms) + " ms is no time of a run");
    }
    const Time time = kRecordingEpoch + Duration(1000 * ms);
    if (last_ && time < *last_) {
      records.FailColumn(2,
                         "time goes backwards by " +
                             std::to_string((*last_ - time).count() / 1000) +
                             " ms");
    }
    last_ = time;
    return time;
  }

 private:
  std::optional<Time> last_;
};

void RequireTag(const TextRecords& records, std::string_view tag) {
  if (records.Text(1) == tag) return;
  records.FailColumn(1, "\"" + std::string(tag) + "\" needed");
}

void ReadMotors(const std::string& path, Recording* recording) {
  TextRecords records(path, TextRecords::Separator::kBlanks);
  StampReader stamps;
  int num_merged = 0;
  while (records.Next()) {
    RequireTag(records, "M");
    records.RequireColumns(14);
    EncoderReading reading;
    reading.time = stamps.Read(records);
    reading.left = records.Integer(3);
    reading.right = records.Integer(7);
    auto& encoders = recording->encoders;
    reading.seq = static_cast<std::int64_t>(encoders.size());
    if (!encoders.empty() && encoders.back().time == reading.time) {
      if (encoders.back().left != reading.left ||
          encoders.back().right != reading.right) {
        records.Fail("repeats the stamp of the line before with other counts");
      }
      ++num_merged;
      continue;
    }
    encoders.push_back(reading);
  }
  if (recording->encoders.empty()) throw InputError(path + ": has no records");
  if (num_merged > 0) {
    recording->notes.push_back(
        std::to_string(num_merged) +
        " motor records that repeat stamp and counts of the one before merged");
  }
}

void ReadReference(const std::string& path, Recording* recording) {
  Reference& reference = recording->reference;
  reference.source = "overhead camera";
  reference.p_RS = {kScannerAhead, 0.0};
  // From sample to sample, fitted dead reckoning and camera differ by 11 mm
  // in the plane: 8 mm for one sample, 6 mm for one coordinate.
  reference.sigma = {0.006, 0.006, kPi};
  TextRecords records(path, TextRecords::Separator::kBlanks);
  StampReader stamps;
  while (records.Next()) {
    RequireTag(records, "P");
    records.RequireColumns(4);
    TruthSample sample;
    sample.p_RS = reference.p_RS;
    sample.time = stamps.Read(records);
    if (!reference.samples.empty() &&
        reference.samples.back().time == sample.time) {
      records.FailColumn(2, "repeats the stamp of the line before");
    }
    sample.p_WS = {1e-3 * records.Number(3), 1e-3 * records.Number(4)};
    reference.samples.push_back(sample);
  }
  if (reference.samples.empty()) throw InputError(path + ": has no records");
}

void ReadScans(const std::string& path, Recording* recording) {
  TextRecords records(path, TextRecords::Separator::kBlanks);
  StampReader stamps;
  while (records.Next()) {
    RequireTag(records, "S");
    RangeScan scan;
    scan.time = stamps.Read(records);
    const std::int64_t count = records.Integer(3);
    if (count < 1 || count != records.num_columns() - 3) {
      records.FailColumn(3,
                         std::to_string(count) + " ranges stated, " +
                             std::to_string(records.num_columns() - 3) +
                             " follow");
    }
    scan.first_angle = -kForwardBeam * kBeamStep + kMountingAngle;
    scan.step = kBeamStep;
    for (int column = 4; column <= records.num_columns(); ++column) {
      scan.ranges.push_back(static_cast<float>(1e-3 * records.Number(column)));
    }
    recording->scans.push_back(std::move(scan));
  }
}

}  // namespace

Recording ReadBrennerLegoRobot4(const std::string& folder) {
  const std::string prefix = FindPrefix(folder);
  Recording recording;
  recording.format = "brenner_lego_robot4";
  recording.name = std::filesystem::path(prefix).filename().string();
  ReadMotors(prefix + std::string(kMotorsSuffix), &recording);
  ReadReference(prefix + "_reference.txt", &recording);
  const std::string scan_path = prefix + "_scan.txt";
  if (std::filesystem::exists(scan_path)) ReadScans(scan_path, &recording);

  // The course states 0.349 mm per tick and a gauge of 150 to 173 mm.
  const Time first = recording.encoders.front().time;
  recording.nominal = NominalParameters(
      first, {0.349e-3, 0.349e-3, 0.150}, {17e-6, 17e-6, 0.023});
  // Stated for the scanner: 1850 mm, 1897 mm, 213 degrees.
  const Pose2 X_WS{1.850, 1.897, WrapAngle(RadiansFromDegrees(213.0))};
  recording.start = StatedStart(first,
                                X_WS * Inverse(Pose2{kScannerAhead, 0.0, 0.0}),
                                {0.006, 0.006, RadiansFromDegrees(1.0)});
  recording.notes.push_back(
      "assumed: reference good to 6 mm a coordinate, start heading to 1 deg");
  return recording;
}

}  // namespace waymark
