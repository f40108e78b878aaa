// Logs as tables: one CSV file per channel.
#pragma once

#include "logs/log_tool/type_table.h"
#include "processes/support/output_file.h"

#include <cstdint>
#include <string>
#include <vector>

namespace waymark {

struct CsvFile {
  std::string path;
  std::int64_t num_rows = 0;
};

struct CsvReport {
  std::vector<CsvFile> files;
  std::vector<std::string> left_out;  // "CHANNEL: why", not written.
  std::int64_t num_undecodable = 0;
};

// A message with more values than this is no table row: images, point clouds.
inline constexpr std::size_t kMaxCsvColumns = 5000;

// Writes <folder>/<channel>.csv, or <channel>.<type>.csv where a channel holds
// several types: a header line, then event_utime (us) and every value of each
// message in its order; numbers with all their digits, arrays of bytes as their
// length, text in quotes where it needs them, nothing where a shorter array has
// no such element. Makes the folder if it is missing.
//
// Throws InputError where reading or writing fails or a file exists (kFail).
CsvReport ExportCsv(const std::string& log,
                    const std::string& folder,
                    TypeTable* types,
                    IfExists if_exists = IfExists::kFail);

}  // namespace waymark
