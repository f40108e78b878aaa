// Lines of a text file as fields, with errors that name file, line and column.
#pragma once

#include "estimation/base/input_error.h"

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace waymark {

// Whole content of a file of at most 1 GiB. Throws as ReadWholeFile() does, and
// InputError where it is empty.
[[nodiscard]] std::string ReadRecordsFile(const std::string& path);

class TextRecords {
 public:
  enum class Separator { kBlanks, kComma };

  // Throws InputError as ReadRecordsFile() does.
  TextRecords(const std::string& path, Separator separator);

  // Moves to the next line that is not blank; false at the end.
  bool Next();

  // The current line without its end.
  [[nodiscard]] std::string_view line() const { return line_; }
  [[nodiscard]] int line_number() const { return line_number_; }
  [[nodiscard]] int num_columns() const {
    return static_cast<int>(fields_.size());
  }

  // Fields of the current line, the first column is 1. Numbers are finite.
  // All throw InputError "path:line: column 3: "abc" is not a number".
  [[nodiscard]] std::string_view Text(int column) const;
  [[nodiscard]] double Number(int column) const;
  [[nodiscard]] std::int64_t Integer(int column) const;
  void RequireColumns(int num_columns) const;

  [[noreturn]] void Fail(const std::string& what) const;
  [[noreturn]] void FailColumn(int column, const std::string& what) const;

 private:
  std::string path_;
  Separator separator_;
  std::string content_;
  std::size_t position_ = 0;
  std::string_view line_;
  int line_number_ = 0;
  std::vector<std::string_view> fields_;
};

}  // namespace waymark
