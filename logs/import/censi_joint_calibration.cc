#include "logs/import/censi_joint_calibration.h"

#include "estimation/geometry/angle.h"
#include "logs/import/text_records.h"
#include "logs/import/virtual_counter.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>

namespace waymark {
namespace {

using Json = nlohmann::json;

// Wheels of a Khepera III by its manual: diameter 41 mm, 88.41 mm apart.
constexpr double kWheelRadius = 0.0205;
constexpr double kWheelBase = 0.08841;
constexpr double kMaxInterval = 60.0;  // s; the recordings have 0.8 to 1.0.
// The authors' residual medians after calibration are 0.69 to 0.74 mm and 1.1
// to 1.5 mrad. A normal distribution's median magnitude is 1.18 sigma in the
// plane and 0.67 sigma in one angle.
constexpr double kSigmaPosition = 0.0006;
constexpr double kSigmaYaw = 0.002;

struct Tuple {
  double seconds = 0.0;
  double left_rate = 0.0;   // rad/s.
  double right_rate = 0.0;  // rad/s.
  Pose2 X_S0S1;
};

double NumberIn(const Json& value, const std::string& what) {
  if (!value.is_number()) throw InputError(what + " is not a number");
  const auto number = value.get<double>();
  if (!std::isfinite(number)) throw InputError(what + " is not finite");
  return number;
}

double Entry(const Json& object, const char* key) {
  const std::string what = std::string("\"") + key + "\"";
  const auto found = object.find(key);
  if (found == object.end()) throw InputError(what + " is missing");
  return NumberIn(*found, what);
}

// Throws InputError that says what is wrong, not where.
Tuple TupleFrom(const Json& object) {
  if (!object.is_object()) throw InputError("is not a JSON object");
  Tuple tuple;
  tuple.seconds = Entry(object, "T");
  if (tuple.seconds <= 0.0 || tuple.seconds > kMaxInterval) {
    throw InputError("\"T\" is " + std::to_string(tuple.seconds) +
                     " s, more than 0 and at most 60 allowed");
  }
  tuple.left_rate = Entry(object, "phi_l");
  tuple.right_rate = Entry(object, "phi_r");
  // Beyond this (0.2 km/s at the rim) virtual counts could overflow.
  constexpr double kMaxRate = 1e4;
  if (std::abs(tuple.left_rate) > kMaxRate ||
      std::abs(tuple.right_rate) > kMaxRate) {
    throw InputError("wheel velocity beyond 1e4 rad/s");
  }
  const auto motion = object.find("sm");
  if (motion == object.end() || !motion->is_array() || motion->size() != 3) {
    throw InputError("\"sm\" is not a list of 3 numbers");
  }
  std::array<double, 3> numbers{};
  for (std::size_t i = 0; i < 3; ++i) {
    numbers[i] =
        NumberIn((*motion)[i], "entry " + std::to_string(i) + " of \"sm\"");
  }
  tuple.X_S0S1 = {numbers[0], numbers[1], WrapAngle(numbers[2])};
  return tuple;
}

// One line holds one or more objects. Each ends where its braces close; the
// format has no strings with braces in them.
std::vector<Tuple> TuplesFromLine(std::string_view line) {
  std::vector<Tuple> tuples;
  std::size_t begin = 0;
  int depth = 0;
  for (std::size_t i = 0; i < line.size(); ++i) {
    if (line[i] == '{') ++depth;
    if (line[i] == '}') --depth;
    const bool is_end = line[i] == '}' && depth == 0;
    if (!is_end && i + 1 < line.size()) continue;
    const std::string_view text = line.substr(begin, i + 1 - begin);
    const Json object = Json::parse(text, nullptr, /*allow_exceptions=*/false);
    if (object.is_discarded()) throw InputError("is not a JSON object");
    tuples.push_back(TupleFrom(object));
    begin = line.find_first_not_of(" \t", i + 1);
    if (begin == std::string_view::npos) break;
    i = begin - 1;
  }
  return tuples;
}

std::vector<Tuple> ReadTuples(const std::string& path) {
  TextRecords records(path, TextRecords::Separator::kBlanks);
  std::vector<Tuple> tuples;
  while (records.Next()) {
    try {
      const auto in_line = TuplesFromLine(records.line());
      tuples.insert(tuples.end(), in_line.begin(), in_line.end());
    } catch (const InputError& error) {
      records.Fail(error.what());
    }
  }
  if (tuples.empty()) throw InputError(path + ": has no records");
  return tuples;
}

Pose2 MountingFor(const std::string& path, const CensiOptions& options) {
  if (options.X_RS) return *options.X_RS;
  const std::string name = std::filesystem::path(path).filename().string();
  if (name.starts_with("lstraight")) return {};
  if (name.starts_with("l90")) return {0.0, 0.0, -0.5 * kPi};
  throw InputError(path +
                   ": the mounting of the laser does not follow from the name "
                   "(lstraight* or l90*), state it");
}

}  // namespace

std::vector<std::string> FindCensiTuples(const std::string& folder) {
  std::vector<std::string> paths;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(folder, error)) {
    const std::string path = entry.path().string();
    if (path.ends_with(".tuple")) paths.push_back(path);
  }
  if (error) throw InputError(folder + ": " + error.message());
  if (paths.empty()) throw InputError(folder + ": no file *.tuple");
  std::sort(paths.begin(), paths.end());
  return paths;
}

Recording ReadCensiTuples(const std::string& path,
                          const CensiOptions& options) {
  const std::vector<Tuple> tuples = ReadTuples(path);
  Recording recording;
  recording.format = "censi_joint_calibration";
  recording.name = std::filesystem::path(path).stem().string();
  recording.has_virtual_ticks = true;
  recording.virtual_resolution = "1e-06 rad of wheel turn";

  RelativeMotion motion;
  motion.source = "scan matching, " + recording.name;
  motion.X_RS = MountingFor(path, options);
  motion.covariance = Eigen::Vector3d(kSigmaPosition, kSigmaPosition, kSigmaYaw)
                          .cwiseAbs2()
                          .asDiagonal();
  VirtualCounter right(kCensiResolution);
  VirtualCounter left(kCensiResolution);
  EncoderReading reading;
  reading.time = kRecordingEpoch;
  recording.encoders.push_back(reading);
  for (const Tuple& tuple : tuples) {
    right.Add(tuple.right_rate * tuple.seconds);
    left.Add(tuple.left_rate * tuple.seconds);
    motion.from = reading.time;
    // At least a microsecond, so that times increase.
    reading.time += std::max(DurationFromSeconds(tuple.seconds), Duration(1));
    ++reading.seq;
    reading.right = right.ticks();
    reading.left = left.ticks();
    recording.encoders.push_back(reading);
    motion.time = reading.time;
    motion.X_S0S1 = tuple.X_S0S1;
    recording.motions.push_back(motion);
    ++motion.seq;
  }
  const double k = kWheelRadius * kCensiResolution;
  recording.nominal =
      NominalParameters(kRecordingEpoch,
                        {k, k, kWheelBase},
                        {0.03 * k, 0.03 * k, 0.03 * kWheelBase});
  recording.notes.push_back(
      "intervals put one after the other; dropped ones are not recorded");
  recording.notes.push_back(
      "assumed: scan matching good to 0.6 mm a coordinate and 2 mrad, from the "
      "authors' residual medians");
  return recording;
}

CensiResult ReadCensiResult(const std::string& path) {
  const Json object =
      Json::parse(ReadRecordsFile(path), nullptr, /*allow_exceptions=*/false);
  if (!object.is_object()) throw InputError(path + ": is not a JSON object");
  CensiResult result;
  try {
    result.wheels = {0.5 * Entry(object, "r_diam"),
                     0.5 * Entry(object, "l_diam"),
                     Entry(object, "axle")};
    result.X_RS = {Entry(object, "l_x"),
                   Entry(object, "l_y"),
                   WrapAngle(Entry(object, "l_theta"))};
    // Theirs is of (radius left, radius right, axle, x, y, yaw).
    constexpr std::array<std::size_t, 6> kFrom = {1, 0, 2, 3, 4, 5};
    const auto covariance = object.find("covariance");
    for (std::size_t i = 0; i < 6; ++i) {
      for (std::size_t j = 0; j < 6; ++j) {
        const std::string what = "\"covariance\" row " + std::to_string(i) +
                                 " column " + std::to_string(j);
        if (covariance == object.end() || !covariance->is_array() ||
            covariance->size() != 6 || !(*covariance)[i].is_array() ||
            (*covariance)[i].size() != 6) {
          throw InputError("\"covariance\" is not a 6 x 6 list");
        }
        result.covariance(static_cast<int>(i), static_cast<int>(j)) =
            NumberIn((*covariance)[kFrom[i]][kFrom[j]], what);
      }
    }
  } catch (const InputError& error) {
    throw InputError(path + ": " + error.what());
  }
  return result;
}

}  // namespace waymark
