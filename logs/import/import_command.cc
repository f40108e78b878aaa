#include "logs/import/import_command.h"

#include "estimation/geometry/angle.h"
#include "logs/import/import_formats.h"
#include "logs/import/write_imported_log.h"
#include "processes/support/run_tool.h"

#include <CLI/CLI.hpp>

#include <cstdio>
#include <filesystem>
#include <map>
#include <memory>
#include <set>
#include <stdexcept>
#include <utility>

namespace waymark {
namespace {

namespace fs = std::filesystem;

struct ImportOptions {
  std::vector<std::string> paths;  // Inputs, then the output.
  std::string format;
  std::string use = "running";
  std::vector<double> mounting;  // x m, y m, yaw degrees.
  double reference_delay_s = 0.0;
  bool force = false;
  ReferenceSplitOptions split;
};

// The output of each recording: a file, or one in a folder by its name.
std::vector<std::string> OutputPaths(const std::string& out,
                                     const std::vector<Recording>& recordings) {
  const bool is_folder = fs::is_directory(out) || out.ends_with("/");
  if (!is_folder && recordings.size() == 1) return {out};
  if (!is_folder && out.ends_with(".log")) {
    throw InputError(out + ": " + std::to_string(recordings.size()) +
                     " recordings go into a folder, not into one log");
  }
  std::vector<std::string> paths;
  std::set<std::string> names;
  for (const Recording& recording : recordings) {
    if (!names.insert(recording.name).second) {
      throw InputError(out + ": two recordings are named " + recording.name);
    }
    paths.push_back((fs::path(out) / (recording.name + ".log")).string());
  }
  std::error_code error;
  fs::create_directories(out, error);
  if (error) throw InputError(out + ": " + error.message());
  return paths;
}

struct Inputs {
  std::vector<Recording> recordings;
  std::vector<std::string> paths;
};

Inputs ReadAll(const ImportOptions& options) {
  // The first word may name the format, unless such a file is there.
  std::vector<std::string> inputs(options.paths.begin(),
                                  options.paths.end() - 1);
  std::optional<ImportFormat> format = ImportFormatFromName(options.format);
  if (!format && inputs.size() > 1 && !fs::exists(inputs.front())) {
    format = ImportFormatFromName(inputs.front());
    if (format) inputs.erase(inputs.begin());
  }
  std::optional<Pose2> mounting;
  if (!options.mounting.empty()) {
    mounting = Pose2{options.mounting[0],
                     options.mounting[1],
                     WrapAngle(RadiansFromDegrees(options.mounting[2]))};
  }
  Inputs all;
  for (const std::string& input : inputs) {
    for (const ImportTask& task : FindImportTasks(input, format)) {
      all.paths.push_back(task.path);
      all.recordings.push_back(ReadImportTask(task, mounting));
      if (options.reference_delay_s != 0.0) {
        SetReferenceBack(options.reference_delay_s, &all.recordings.back());
      }
      if (options.split.use_heading) {
        for (const TruthSample& sample :
             all.recordings.back().reference.samples) {
          if (sample.heading) continue;
          throw InputError(task.path +
                           ": --heading: the reference has no headings");
        }
      }
    }
  }
  return all;
}

std::string SummaryText(const ImportSummary& summary) {
  std::string text = std::to_string(summary.num_encoders) + " encoder readings";
  const auto add = [&](std::int64_t count, const char* what) {
    if (count > 0) text += ", " + std::to_string(count) + " " + what;
  };
  add(summary.num_motions, "relative motions");
  add(summary.num_fixes, "fixes");
  add(summary.num_truth, "truth samples");
  add(summary.num_scans, "range scans");
  char numbers[96];
  std::snprintf(numbers,
                sizeof(numbers),
                "; %.1f s, %.2f m%s",
                summary.duration_s,
                summary.path_m,
                summary.path_by_wheels ? " by the wheels" : "");
  return text + numbers;
}

void Run(const ImportOptions& options) {
  if (options.paths.size() < 2) {
    throw InputError("import: at least one input and the output needed");
  }
  try {
    options.split.Check();
  } catch (const std::invalid_argument& error) {
    throw InputError(std::string("import: ") + error.what());
  }
  const IfExists if_exists =
      options.force ? IfExists::kReplace : IfExists::kFail;
  // Everything is read before anything is written.
  const auto [recordings, inputs] = ReadAll(options);
  const std::vector<std::string> paths =
      OutputPaths(options.paths.back(), recordings);
  for (const std::string& path : paths) {
    CheckOutput(path, if_exists, inputs);
  }
  std::map<std::string, int> notes;
  for (std::size_t i = 0; i < recordings.size(); ++i) {
    const ImportSummary summary =
        WriteImportedLog(recordings[i], options.split, paths[i], if_exists);
    std::printf("%s: %s\n", paths[i].c_str(), SummaryText(summary).c_str());
    // Long imports show how far they are also through a pipe.
    std::fflush(stdout);
    for (const std::string& note : recordings[i].notes) ++notes[note];
  }
  for (const auto& [note, count] : notes) {
    if (recordings.size() == 1) {
      std::printf("  %s\n", note.c_str());
    } else {
      std::printf("  %d of %zu: %s\n", count, recordings.size(), note.c_str());
    }
  }
}

}  // namespace

void AddImportCommand(CLI::App* app, int* /*exit_code*/) {
  auto options = std::make_shared<ImportOptions>();
  CLI::App* command =
      app->add_subcommand("import", "Makes logs of recordings by others");
  command
      ->add_option("paths",
                   options->paths,
                   "[FORMAT] INPUT [INPUT...] OUT: files or folders of "
                   "recordings, then the log to write; a folder where there "
                   "are several recordings")
      ->required();
  command
      ->add_option("--format",
                   options->format,
                   "Format of the inputs; found out where left out")
      ->check(CLI::IsMember(ImportFormatNames()));
  command
      ->add_option("--use",
                   options->use,
                   "running: every k-th reference sample, with added noise, "
                   "becomes POSITION_FIX, the others TRUTH; calibration: all "
                   "become POSITION_FIX as they are")
      ->check(CLI::IsMember({"running", "calibration"}))
      ->capture_default_str();
  command->add_option("--every", options->split.every, "The k of --use running")
      ->check(CLI::Range(1, 1000000))
      ->capture_default_str();
  RequireRange(
      command->add_option("--noise-m",
                          options->split.noise_m,
                          "Sigma of the noise added to x and y each, m"),
      0.0,
      10.0)
      ->capture_default_str();
  RequireRange(
      command->add_option("--noise-rad",
                          options->split.noise_rad,
                          "Sigma of the noise added to the heading, rad"),
      0.0,
      10.0)
      ->capture_default_str();
  command->add_option("--seed", options->split.seed, "Of the added noise")
      ->capture_default_str();
  command->add_flag("--heading",
                    options->split.use_heading,
                    "Fixes carry the reference's heading too");
  RequireRange(
      command->add_option(
          "--mounting",
          options->mounting,
          "Pose of the sensor on the robot where the recording does not tell "
          "(Censi): x m, y m, yaw in degrees"),
      -360.0,
      360.0)
      ->expected(3);
  RequireRange(
      command->add_option(
          "--reference-delay",
          options->reference_delay_s,
          "How much later than it was the reference's stamps say that a sample "
          "was taken, s; they are set back by this"),
      -10.0,
      10.0)
      ->capture_default_str();
  command->add_flag("-f,--force", options->force, "Replace outputs that exist");
  command->callback([options, command] {
    for (const char* flag : {"--every", "--noise-m", "--noise-rad", "--seed"}) {
      if (options->use == "calibration" && command->count(flag) > 0) {
        throw InputError(std::string(flag) + ": goes with --use running only");
      }
    }
    options->split.use = options->use == "calibration"
                             ? ReferenceUse::kCalibration
                             : ReferenceUse::kRunning;
    Run(*options);
  });
}

}  // namespace waymark
