// A recording as an LCM log.
#pragma once

#include "logs/import/recording.h"
#include "logs/import/reference_split.h"
#include "processes/support/log_file.h"

#include <cstdint>
#include <string>

namespace waymark {

struct ImportSummary {
  std::int64_t num_events = 0;
  std::int64_t num_encoders = 0;
  std::int64_t num_fixes = 0;
  std::int64_t num_truth = 0;
  std::int64_t num_motions = 0;
  std::int64_t num_scans = 0;
  double duration_s = 0.0;  // From the first to the last event.
  double path_m = 0.0;      // Of the reference; of the wheels without one.
  bool path_by_wheels = false;
};

// Writes, in order of time (event time = utime), and of this list where times
// are equal:
//
//   CONFIG               once: process "waymark-log import", all options and
//                        the recording's notes
//   ODOMETRY_PARAMETERS  once: what the authors state, source "nominal"
//   INITIAL_POSE         where the recording states a start
//   ENCODERS, RELATIVE_MOTION, POSITION_FIX, TRUTH, RANGES
//
// Writes beside `path` first and renames, so that no half log is left. Same
// recording and options, same bytes. Throws InputError where `path` exists
// (kFail) or cannot be written, and as SplitReference does.
ImportSummary WriteImportedLog(const Recording& recording,
                               const ReferenceSplitOptions& options,
                               const std::string& path,
                               IfExists if_exists);

}  // namespace waymark
