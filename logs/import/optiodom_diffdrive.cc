#include "logs/import/optiodom_diffdrive.h"

#include "estimation/geometry/angle.h"
#include "logs/import/text_records.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <sstream>

namespace waymark {
namespace {

constexpr std::string_view kRunMark = "_run-";

constexpr double kDiameter = 0.084;  // m, both wheels.
constexpr double kWheelBase = 0.2;   // m.

// As published for every run.
struct Metadata {
  double gear = 43.7;            // Motor turns per wheel turn.
  double ticks_per_turn = 64.0;  // Of the motor.
  // What the robot's own controller was told.
  double told_diameter = kDiameter;
  double told_base = kWheelBase;
};

double PositiveNumber(const TextRecords& records, int column) {
  const double value = records.Number(column);
  if (value <= 0.0) records.FailColumn(column, "must be positive");
  return value;
}

Metadata ReadMetadata(const std::string& path) {
  Metadata metadata;
  TextRecords records(path, TextRecords::Separator::kComma);
  while (records.Next()) {
    const std::string_view key = records.Text(1);
    if (key == "type" && records.Text(2) != "diff") {
      records.FailColumn(2, "\"diff\" needed, a differential drive");
    } else if (key == "ngear") {
      metadata.gear = PositiveNumber(records, 2);
    } else if (key == "encRes") {
      metadata.ticks_per_turn = PositiveNumber(records, 2);
    } else if (key == "Li") {
      metadata.told_base = PositiveNumber(records, 2);
    } else if (key == "Di") {
      metadata.told_diameter = PositiveNumber(records, 2);
    }
  }
  return metadata;
}

OdometryParameters NominalFrom(Time time, const Metadata& metadata) {
  const double k = kPi * kDiameter / (metadata.ticks_per_turn * metadata.gear);
  // Diameters are stated to a millimetre; tyres make the effective base
  // differ from the drawing by a few millimetres.
  return NominalParameters(
      time, {k, k, kWheelBase}, {0.01 * k, 0.01 * k, 0.02 * kWheelBase});
}

// What the metadata say beside the run; defaults and a note without them.
Metadata MetadataFor(const std::filesystem::path& file,
                     std::vector<std::string>* notes) {
  const std::string stem = file.stem().string();
  const std::size_t mark = stem.find(kRunMark);
  const std::filesystem::path path =
      file.parent_path() / (stem.substr(0, mark) + "_metadata.csv");
  if (mark == std::string::npos || !std::filesystem::exists(path)) {
    notes->push_back("no metadata file: 64 x 43.7 ticks a turn as published");
    return {};
  }
  const Metadata metadata = ReadMetadata(path.string());
  if (metadata.told_diameter != kDiameter || metadata.told_base != kWheelBase) {
    std::ostringstream note;
    note << "metadata state wheels of " << metadata.told_diameter << " m, "
         << metadata.told_base
         << " m apart (what the controller was told); nominal stays 0.084 m "
            "and 0.2 m";
    notes->push_back(note.str());
  }
  return metadata;
}

std::int64_t TicksOfCycle(const TextRecords& records, int column) {
  const std::int64_t ticks = records.Integer(column);
  // 50 ms of the fastest motor are some thousands; sums must not overflow.
  constexpr std::int64_t kMaxTicks = 1'000'000;
  if (std::abs(ticks) > kMaxTicks) {
    records.FailColumn(column, "is beyond 1e6 ticks in a cycle");
  }
  return ticks;
}

void ReadSamples(const std::string& path, Recording* recording) {
  TextRecords records(path, TextRecords::Separator::kComma);
  EncoderReading reading;
  while (records.Next()) {
    records.RequireColumns(6);
    const double seconds = records.Number(1);
    // A day: beyond that the column is no run's clock.
    if (seconds < 0.0 || seconds > 86400.0) {
      records.FailColumn(1, "is no time of a run, 0 to 86400 s");
    }
    reading.time = kRecordingEpoch + DurationFromSeconds(seconds);
    if (!recording->encoders.empty() &&
        reading.time <= recording->encoders.back().time) {
      records.FailColumn(1, "time does not increase");
    }
    reading.right += TicksOfCycle(records, 5);
    reading.left += TicksOfCycle(records, 6);
    TruthSample sample;
    sample.time = reading.time;
    sample.p_WS = {records.Number(2), records.Number(3)};
    sample.heading = WrapAngle(records.Number(4));
    recording->encoders.push_back(reading);
    recording->reference.samples.push_back(sample);
    ++reading.seq;
  }
  if (recording->encoders.empty()) throw InputError(path + ": has no records");
}

}  // namespace

std::vector<std::string> FindOptiodomRuns(const std::string& folder) {
  std::vector<std::string> paths;
  std::error_code error;
  std::filesystem::recursive_directory_iterator entries(folder, error);
  if (error) throw InputError(folder + ": " + error.message());
  for (const auto& entry : entries) {
    const std::string name = entry.path().filename().string();
    if (name.find(kRunMark) != std::string::npos && name.ends_with(".csv")) {
      paths.push_back(entry.path().string());
    }
  }
  if (paths.empty()) throw InputError(folder + ": no file *_run-NN.csv");
  std::sort(paths.begin(), paths.end());
  return paths;
}

Recording ReadOptiodomRun(const std::string& path) {
  const std::filesystem::path file(path);
  Recording recording;
  recording.format = "optiodom_diffdrive";
  recording.name = file.stem().string();
  recording.reference.source = "OptiTrack";
  // Samples at rest scatter by 0.1 mm; what the rigid body's centre is off
  // the axle's middle by is not recorded.
  recording.reference.sigma = {0.001, 0.001, 0.003};
  ReadSamples(path, &recording);

  const Metadata metadata = MetadataFor(file, &recording.notes);
  const TruthSample& first = recording.reference.samples.front();
  recording.nominal = NominalFrom(first.time, metadata);
  // Some runs start while the robot turns; one cycle of delay between ticks
  // and motion capture is then 20 mrad.
  recording.start =
      StatedStart(first.time,
                  {first.p_WS.x(), first.p_WS.y(), *first.heading},
                  {0.002, 0.002, 0.02});
  recording.notes.push_back(
      "assumed: reference good to 1 mm a coordinate and 3 mrad");
  return recording;
}

}  // namespace waymark
