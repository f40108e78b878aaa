// Aligned columns for people.
#pragma once

#include <string>
#include <vector>

namespace waymark {

class TextTable {
 public:
  // Columns whose name starts with '<' are aligned left, without the sign.
  explicit TextTable(std::vector<std::string> columns);
  // As many cells as columns.
  void AddRow(std::vector<std::string> cells);
  // Header and rows, two blanks between columns, each line ended.
  [[nodiscard]] std::string Text() const;

 private:
  std::vector<bool> is_left_;
  std::vector<std::vector<std::string>> rows_;
};

// printf's "%.*f".
[[nodiscard]] std::string Fixed(double value, int num_decimals);
// "3.2 MB", "812 bytes".
[[nodiscard]] std::string ReadableBytes(double num_bytes);

}  // namespace waymark
