// Which importer reads a file or folder.
#pragma once

#include "estimation/geometry/pose2.h"
#include "logs/import/recording.h"

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace waymark {

enum class ImportFormat {
  kBrennerLegoRobot4,
  kCensiJointCalibration,
  kLcmMaebotLogs,
  kOptiodomDiffdrive,
  kTucLabyrinthDiffdrive,
};

// "brenner_lego_robot4", ...: the names of the data sets' folders.
[[nodiscard]] std::string_view NameOf(ImportFormat format);
[[nodiscard]] std::optional<ImportFormat> ImportFormatFromName(
    std::string_view name);
[[nodiscard]] std::vector<std::string> ImportFormatNames();

// Looks at the content: of a file at its first bytes, of a folder at the names
// in it (and below it, for OptiOdom). Throws InputError where `path` is not
// there or is none of the formats.
[[nodiscard]] ImportFormat DetectImportFormat(const std::string& path);

// One recording to read: a file, or for LEGO and TUC a folder.
struct ImportTask {
  ImportFormat format = ImportFormat::kBrennerLegoRobot4;
  std::string path;
};

// What `path` holds; a folder of runs gives one task for each, in order of
// their names. Detects the format where none is given. A file of a recording
// that consists of several stands for its folder. Throws InputError where
// there is nothing of that format.
[[nodiscard]] std::vector<ImportTask> FindImportTasks(
    const std::string& path, std::optional<ImportFormat> format);

// `mounting`: of the sensor on the robot, for formats that do not record it.
[[nodiscard]] Recording ReadImportTask(const ImportTask& task,
                                       const std::optional<Pose2>& mounting);

}  // namespace waymark
