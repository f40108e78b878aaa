#include "logs/import/optiodom_diffdrive.h"

#include "estimation/geometry/angle.h"
#include "logs/import/text_records.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

namespace waymark {
namespace {

constexpr std::string_view kRunMark = "_run-";

// As published for every run.
struct Wheels {
  double gear = 43.7;             // Motor turns per wheel turn.
  double ticks_per_turn = 64.0;   // Of the motor.
  double diameter_right = 0.084;  // m.
  double diameter_left = 0.084;   // m.
  double wheel_base = 0.2;        // m.
};

double PositiveNumber(const TextRecords& records, int column) {
  const double value = records.Number(column);
  if (value <= 0.0) records.FailColumn(column, "must be positive");
  return value;
}

Wheels ReadMetadata(const std::string& path) {
  Wheels wheels;
  TextRecords records(path, TextRecords::Separator::kComma);
  while (records.Next()) {
    const std::string_view key = records.Text(1);
    if (key == "type" && records.Text(2) != "diff") {
      records.FailColumn(2, "\"diff\" needed, a differential drive");
    } else if (key == "ngear") {
      wheels.gear = PositiveNumber(records, 2);
    } else if (key == "encRes") {
      wheels.ticks_per_turn = PositiveNumber(records, 2);
    } else if (key == "Li") {
      wheels.wheel_base = PositiveNumber(records, 2);
    } else if (key == "Di") {
      wheels.diameter_right = PositiveNumber(records, 2);
      wheels.diameter_left = PositiveNumber(records, 3);
    }
  }
  return wheels;
}

OdometryParameters NominalFrom(Time time, const Wheels& wheels) {
  const double ticks = wheels.ticks_per_turn * wheels.gear;
  const WheelParameters parameters{kPi * wheels.diameter_right / ticks,
                                   kPi * wheels.diameter_left / ticks,
                                   wheels.wheel_base};
  // Diameters are stated to a millimetre; tyres make the effective base
  // differ from the drawing by a few millimetres.
  return NominalParameters(time,
                           parameters,
                           {0.01 * parameters.k_right,
                            0.01 * parameters.k_left,
                            0.02 * parameters.wheel_base});
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
    reading.right += records.Integer(5);
    reading.left += records.Integer(6);
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
  const std::string stem = file.stem().string();
  Recording recording;
  recording.format = "optiodom_diffdrive";
  recording.name = stem;
  recording.reference.source = "OptiTrack";
  // Samples at rest scatter by 0.1 mm; what the rigid body's centre is off
  // the axle's middle by is not recorded.
  recording.reference.sigma = {0.001, 0.001, 0.003};
  ReadSamples(path, &recording);

  Wheels wheels;
  const std::size_t mark = stem.find(kRunMark);
  const std::filesystem::path metadata =
      file.parent_path() / (stem.substr(0, mark) + "_metadata.csv");
  if (mark != std::string::npos && std::filesystem::exists(metadata)) {
    wheels = ReadMetadata(metadata.string());
  } else {
    recording.notes.push_back(
        "no metadata file: wheels as published (84 mm, base 0.2 m, 64 x 43.7 "
        "ticks)");
  }
  const TruthSample& first = recording.reference.samples.front();
  recording.nominal = NominalFrom(first.time, wheels);
  recording.start =
      StatedStart(first.time,
                  {first.p_WS.x(), first.p_WS.y(), *first.heading},
                  recording.reference.sigma);
  recording.notes.push_back(
      "assumed: reference good to 1 mm a coordinate and 3 mrad");
  return recording;
}

}  // namespace waymark
