#include "logs/log_tool/text_table.h"

#include "estimation/base/check.h"

#include <algorithm>
#include <cstdio>
#include <utility>

namespace waymark {

TextTable::TextTable(std::vector<std::string> columns) {
  for (auto& name : columns) {
    is_left_.push_back(name.starts_with('<'));
    if (is_left_.back()) name.erase(0, 1);
  }
  rows_.push_back(std::move(columns));
}

void TextTable::AddRow(std::vector<std::string> cells) {
  WAYMARK_CHECK(cells.size() == is_left_.size(), cells.size());
  rows_.push_back(std::move(cells));
}

std::string TextTable::Text() const {
  std::vector<std::size_t> widths(is_left_.size(), 0);
  for (const auto& row : rows_) {
    for (std::size_t i = 0; i < row.size(); ++i) {
      widths[i] = std::max(widths[i], row[i].size());
    }
  }
  std::string text;
  for (const auto& row : rows_) {
    std::string line;
    for (std::size_t i = 0; i < row.size(); ++i) {
      const std::string blanks(widths[i] - row[i].size(), ' ');
      if (i > 0) line += "  ";
      line += is_left_[i] ? row[i] + blanks : blanks + row[i];
    }
    line.erase(line.find_last_not_of(' ') + 1);
    text += line + "\n";
  }
  return text;
}

std::string Fixed(double value, int num_decimals) {
  char text[400];  // The largest double has 309 digits.
  std::snprintf(text, sizeof(text), "%.*f", num_decimals, value);
  return text;
}

std::string ReadableBytes(double num_bytes) {
  if (num_bytes < 1e3) return Fixed(num_bytes, 0) + " bytes";
  if (num_bytes < 1e6) return Fixed(num_bytes / 1e3, 1) + " kB";
  if (num_bytes < 1e9) return Fixed(num_bytes / 1e6, 1) + " MB";
  return Fixed(num_bytes / 1e9, 2) + " GB";
}

}  // namespace waymark
