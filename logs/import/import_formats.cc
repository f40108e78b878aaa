#include "logs/import/import_formats.h"

#include "estimation/base/input_error.h"
#include "logs/import/brenner_lego_robot4.h"
#include "logs/import/censi_joint_calibration.h"
#include "logs/import/lcm_maebot_logs.h"
#include "logs/import/optiodom_diffdrive.h"
#include "logs/import/tuc_labyrinth_diffdrive.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <system_error>
#include <utility>

namespace waymark {
namespace {

namespace fs = std::filesystem;

constexpr std::array<std::pair<ImportFormat, std::string_view>, 5> kNames = {{
    {ImportFormat::kBrennerLegoRobot4, "brenner_lego_robot4"},
    {ImportFormat::kCensiJointCalibration, "censi_joint_calibration"},
    {ImportFormat::kLcmMaebotLogs, "lcm_maebot_logs"},
    {ImportFormat::kOptiodomDiffdrive, "optiodom_diffdrive"},
    {ImportFormat::kTucLabyrinthDiffdrive, "tuc_labyrinth_diffdrive"},
}};

bool ConsistsOfSeveralFiles(ImportFormat format) {
  return format == ImportFormat::kBrennerLegoRobot4 ||
         format == ImportFormat::kTucLabyrinthDiffdrive;
}

std::optional<ImportFormat> FormatOfFile(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  // Enough for a first line in every format.
  std::array<char, 256> buffer{};
  file.read(buffer.data(), static_cast<std::streamsize>(buffer.size()));
  const std::string_view head(buffer.data(),
                              static_cast<std::size_t>(file.gcount()));
  if (head.starts_with("\xED\xA1\xDA\x01")) {
    return ImportFormat::kLcmMaebotLogs;
  }
  const std::size_t begin = head.find_first_not_of(" \t\r\n");
  const std::string_view text =
      begin == std::string_view::npos ? "" : head.substr(begin);
  if (text.starts_with("M ") || text.starts_with("P ") ||
      text.starts_with("S ")) {
    return ImportFormat::kBrennerLegoRobot4;
  }
  if (text.starts_with("odom2diff ") || text.starts_with("range2 ") ||
      text.starts_with("point2 ")) {
    return ImportFormat::kTucLabyrinthDiffdrive;
  }
  if (text.starts_with("{")) return ImportFormat::kCensiJointCalibration;
  const std::string_view line = text.substr(0, text.find('\n'));
  if (std::count(line.begin(), line.end(), ',') == 5 &&
      line.find_first_not_of("0123456789+-.eE,\r ") == std::string_view::npos) {
    return ImportFormat::kOptiodomDiffdrive;
  }
  return std::nullopt;
}

std::optional<ImportFormat> FormatOfName(const std::string& name) {
  if (name.ends_with("_motors.txt")) return ImportFormat::kBrennerLegoRobot4;
  if (name.ends_with("_Input.txt")) {
    return ImportFormat::kTucLabyrinthDiffdrive;
  }
  if (name.ends_with(".tuple")) return ImportFormat::kCensiJointCalibration;
  if (name.ends_with(".log")) return ImportFormat::kLcmMaebotLogs;
  if (name.ends_with(".csv") && name.find("_run-") != std::string::npos) {
    return ImportFormat::kOptiodomDiffdrive;
  }
  return std::nullopt;
}

std::string KnownFormats() {
  std::string text;
  for (const auto& [format, name] : kNames) {
    text += (text.empty() ? "" : ", ") + std::string(name);
  }
  return text;
}

std::vector<std::string> FindLogs(const std::string& folder) {
  std::vector<std::string> paths;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder, error)) {
    const std::string path = entry.path().string();
    if (path.ends_with(".log")) paths.push_back(path);
  }
  if (error) throw InputError(folder + ": " + error.message());
  if (paths.empty()) throw InputError(folder + ": no file *.log");
  std::sort(paths.begin(), paths.end());
  return paths;
}

}  // namespace

std::string_view NameOf(ImportFormat format) {
  for (const auto& [known, name] : kNames) {
    if (known == format) return name;
  }
  return "";
}

std::optional<ImportFormat> ImportFormatFromName(std::string_view name) {
  for (const auto& [format, known] : kNames) {
    if (known == name) return format;
  }
  return std::nullopt;
}

std::vector<std::string> ImportFormatNames() {
  std::vector<std::string> names;
  for (const auto& [format, name] : kNames) names.emplace_back(name);
  return names;
}

ImportFormat DetectImportFormat(const std::string& path) {
  std::error_code error;
  if (!fs::exists(path, error)) throw InputError(path + ": no such file");
  std::optional<ImportFormat> format;
  if (fs::is_directory(path, error)) {
    for (const auto& entry : fs::recursive_directory_iterator(path, error)) {
      format = FormatOfName(entry.path().filename().string());
      if (format) break;
    }
  } else {
    format = FormatOfFile(path);
  }
  if (format) return *format;
  throw InputError(path + ": is none of the known formats (" + KnownFormats() +
                   ")");
}

std::vector<ImportTask> FindImportTasks(const std::string& path,
                                        std::optional<ImportFormat> format) {
  std::error_code error;
  if (!fs::exists(path, error)) throw InputError(path + ": no such file");
  const ImportFormat known = format ? *format : DetectImportFormat(path);
  const bool is_folder = fs::is_directory(path, error);
  if (ConsistsOfSeveralFiles(known)) {
    const std::string folder = fs::path(path).parent_path().string();
    return {{known, is_folder ? path : folder.empty() ? "." : folder}};
  }
  std::vector<std::string> paths = {path};
  if (is_folder) {
    paths = known == ImportFormat::kOptiodomDiffdrive ? FindOptiodomRuns(path)
            : known == ImportFormat::kCensiJointCalibration
                ? FindCensiTuples(path)
                : FindLogs(path);
  }
  std::vector<ImportTask> tasks;
  for (std::string& each : paths) tasks.push_back({known, std::move(each)});
  return tasks;
}

Recording ReadImportTask(const ImportTask& task,
                         const std::optional<Pose2>& mounting) {
  switch (task.format) {
    case ImportFormat::kBrennerLegoRobot4:
      return ReadBrennerLegoRobot4(task.path);
    case ImportFormat::kCensiJointCalibration:
      return ReadCensiTuples(task.path, CensiOptions{mounting});
    case ImportFormat::kLcmMaebotLogs:
      return ReadMaebotLog(task.path);
    case ImportFormat::kOptiodomDiffdrive:
      return ReadOptiodomRun(task.path);
    case ImportFormat::kTucLabyrinthDiffdrive:
      return ReadTucLabyrinth(task.path);
  }
  throw InputError(task.path + ": unknown format");
}

}  // namespace waymark
