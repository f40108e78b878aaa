// Pieces of an HTML page: tables and pictures.
#pragma once

#include "processes/convert/image_convert.h"

#include <string>
#include <vector>

namespace waymark {

// One cell: text, and a style class or "".
struct Cell {
  std::string text;
  std::string style;
};

// First row is the head. Wide tables scroll inside their own box.
[[nodiscard]] std::string HtmlTable(const std::vector<std::vector<Cell>>& rows);

// A picture inside the page, with its caption.
[[nodiscard]] std::string HtmlFigure(const std::string& caption,
                                     const ImageFile& file);

}  // namespace waymark
