#include "logs/import/tuc_labyrinth_diffdrive.h"

#include "estimation/geometry/angle.h"
#include "logs/import/text_records.h"
#include "logs/import/virtual_counter.h"

#include <cmath>
#include <filesystem>
#include <optional>
#include <vector>

namespace waymark {
namespace {

constexpr std::string_view kInputSuffix = "_Input.txt";

// "folder/Indoor_UWB" for "folder/Indoor_UWB_Input.txt".
std::string FindPrefix(const std::string& folder) {
  std::vector<std::string> prefixes;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(folder, error)) {
    const std::string path = entry.path().string();
    if (path.ends_with(kInputSuffix)) {
      prefixes.push_back(path.substr(0, path.size() - kInputSuffix.size()));
    }
  }
  if (error) throw InputError(folder + ": " + error.message());
  if (prefixes.size() != 1) {
    throw InputError(folder + ": " + std::to_string(prefixes.size()) +
                     " files *_Input.txt, 1 needed");
  }
  return prefixes.front();
}

Time ReadStamp(const TextRecords& records, std::optional<Time> last) {
  const double seconds = records.Number(2);
  // A day: beyond that the column is no run's clock.
  if (seconds < 0.0 || seconds > 86400.0) {
    records.FailColumn(2, "is no time of a run, 0 to 86400 s");
  }
  const Time time = kRecordingEpoch + DurationFromSeconds(seconds);
  if (last && time <= *last) {
    records.FailColumn(2, "time does not increase");
  }
  return time;
}

// Metres that a wheel travelled in `seconds` at the velocity of a column.
double TravelOf(const TextRecords& records, int column, double seconds) {
  const double velocity = records.Number(column);
  // No wheel of a small robot; beyond it virtual counts could overflow.
  if (std::abs(velocity) > 100.0) {
    records.FailColumn(column, "is beyond 100 m/s");
  }
  return velocity * seconds;
}

void ReadInput(const std::string& path, Recording* recording) {
  TextRecords records(path, TextRecords::Separator::kBlanks);
  VirtualCounter right(kTucResolution);
  VirtualCounter left(kTucResolution);
  EncoderReading reading;
  std::optional<Time> last;
  double half_base = 0.0;
  int num_ranges = 0;
  int num_sideways = 0;
  while (records.Next()) {
    if (records.Text(1) == "range2") {
      ++num_ranges;
      continue;
    }
    if (records.Text(1) != "odom2diff") {
      records.FailColumn(1, "\"odom2diff\" or \"range2\" needed");
    }
    records.RequireColumns(9);
    reading.time = ReadStamp(records, last);
    const double seconds = last ? Seconds(reading.time - *last) : 0.0;
    left.Add(TravelOf(records, 3, seconds));
    right.Add(TravelOf(records, 4, seconds));
    if (records.Number(5) != 0.0) ++num_sideways;
    const double base = records.Number(6);
    if (base <= 0.0 || (last && base != half_base)) {
      records.FailColumn(6, "the wheels' distance must be positive and stay");
    }
    half_base = base;
    reading.left = left.ticks();
    reading.right = right.ticks();
    recording->encoders.push_back(reading);
    last = reading.time;
    ++reading.seq;
  }
  if (!last) throw InputError(path + ": has no records odom2diff");
  recording->nominal = NominalParameters(
      recording->encoders.front().time,
      {kTucResolution, kTucResolution, 2.0 * half_base},
      {0.05 * kTucResolution, 0.05 * kTucResolution, 0.1 * half_base});
  recording->notes.push_back(std::to_string(num_ranges) +
                             " ranges to radio beacons left out");
  if (num_sideways > 0) {
    recording->notes.push_back(std::to_string(num_sideways) +
                               " sideways velocities left out");
  }
}

void ReadReference(const std::string& path, Recording* recording) {
  Reference& reference = recording->reference;
  reference.source = "reference of the data set";
  reference.sigma = {0.01, 0.01, kPi};
  TextRecords records(path, TextRecords::Separator::kBlanks);
  std::optional<Time> last;
  while (records.Next()) {
    if (records.Text(1) != "point2") {
      records.FailColumn(1, "\"point2\" needed");
    }
    records.RequireColumns(8);
    TruthSample sample;
    sample.time = ReadStamp(records, last);
    sample.p_WS = {records.Number(3), records.Number(4)};
    reference.samples.push_back(sample);
    last = sample.time;
  }
  if (!last) throw InputError(path + ": has no records");
}

}  // namespace

Recording ReadTucLabyrinth(const std::string& folder) {
  const std::string prefix = FindPrefix(folder);
  Recording recording;
  recording.format = "tuc_labyrinth_diffdrive";
  recording.name = std::filesystem::path(prefix).filename().string();
  recording.has_virtual_ticks = true;
  recording.virtual_resolution = "1e-06 m of wheel travel";
  ReadInput(prefix + std::string(kInputSuffix), &recording);
  ReadReference(prefix + "_GT.txt", &recording);
  recording.notes.push_back(
      "first velocity column is the left wheel and the stated distance half "
      "the wheel base, as the authors' own motion model has it");
  recording.notes.push_back("assumed: reference good to 10 mm a coordinate");
  return recording;
}

}  // namespace waymark
