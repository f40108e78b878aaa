#include "logs/import/text_records.h"

#include "estimation/base/whole_file.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <system_error>

namespace waymark {
namespace {

constexpr std::string_view kBlanks = " \t\r";

std::string_view Trim(std::string_view text) {
  const std::size_t first = text.find_first_not_of(kBlanks);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(kBlanks) - first + 1);
}

std::string Quote(std::string_view text) {
  // Longer fields are somebody's binary file, not a number.
  constexpr std::size_t kMaxShown = 40;
  std::string quoted = "\"";
  for (const char c : text.substr(0, kMaxShown)) {
    quoted += c >= ' ' && c <= '~' ? c : '?';
  }
  return quoted + (text.size() > kMaxShown ? "...\"" : "\"");
}

void SplitBlanks(std::string_view line, std::vector<std::string_view>* fields) {
  std::size_t begin = line.find_first_not_of(kBlanks);
  while (begin != std::string_view::npos) {
    const std::size_t end =
        std::min(line.find_first_of(kBlanks, begin), line.size());
    fields->push_back(line.substr(begin, end - begin));
    begin = line.find_first_not_of(kBlanks, end);
  }
}

void SplitCommas(std::string_view line, std::vector<std::string_view>* fields) {
  std::size_t begin = 0;
  while (true) {
    const std::size_t end = std::min(line.find(',', begin), line.size());
    fields->push_back(Trim(line.substr(begin, end - begin)));
    if (end == line.size()) return;
    begin = end + 1;
  }
}

}  // namespace

std::string ReadRecordsFile(const std::string& path) {
  // Ten hours at 1 kHz in lines of 50 bytes are 1.8 GB, which nobody has put
  // into one file; it is held in memory.
  constexpr std::size_t kMaxBytes = std::size_t{1} << 30U;
  std::string content = ReadWholeFile(path, kMaxBytes);
  if (content.empty()) throw InputError(path + ": is empty");
  return content;
}

TextRecords::TextRecords(const std::string& path, Separator separator)
    : path_(path), separator_(separator), content_(ReadRecordsFile(path)) {}

bool TextRecords::Next() {
  while (position_ < content_.size()) {
    const std::size_t end =
        std::min(content_.find('\n', position_), content_.size());
    line_ = Trim(std::string_view(content_).substr(position_, end - position_));
    position_ = end + 1;
    ++line_number_;
    if (line_.empty()) continue;
    fields_.clear();
    if (separator_ == Separator::kBlanks) {
      SplitBlanks(line_, &fields_);
    } else {
      SplitCommas(line_, &fields_);
    }
    return true;
  }
  return false;
}

std::string_view TextRecords::Text(int column) const {
  if (column < 1 || column > num_columns()) {
    FailColumn(column,
               "is missing, the line has " + std::to_string(num_columns()));
  }
  return fields_[static_cast<std::size_t>(column - 1)];
}

double TextRecords::Number(int column) const {
  const std::string_view text = Text(column);
  double value = 0.0;
  const char* const end = text.data() + text.size();
  const auto result = std::from_chars(text.data(), end, value);
  if (result.ec == std::errc::result_out_of_range) {
    FailColumn(column, Quote(text) + " does not fit a double");
  }
  if (result.ec != std::errc() || result.ptr != end) {
    FailColumn(column, Quote(text) + " is not a number");
  }
  if (!std::isfinite(value)) {
    FailColumn(column, Quote(text) + " is not finite");
  }
  return value;
}

std::int64_t TextRecords::Integer(int column) const {
  const double value = Number(column);
  // Beyond 2^53 a double skips integers.
  constexpr double kMaxExact = 9007199254740992.0;
  if (value != std::floor(value) || std::abs(value) > kMaxExact) {
    FailColumn(column, Quote(Text(column)) + " is not a whole number");
  }
  return static_cast<std::int64_t>(value);
}

void TextRecords::RequireColumns(int expected) const {
  if (num_columns() == expected) return;
  Fail(std::to_string(num_columns()) + " columns, " + std::to_string(expected) +
       " needed");
}

void TextRecords::Fail(const std::string& what) const {
  throw InputError(path_ + ":" + std::to_string(line_number_) + ": " + what);
}

void TextRecords::FailColumn(int column, const std::string& what) const {
  Fail("column " + std::to_string(column) + ": " + what);
}

}  // namespace waymark
