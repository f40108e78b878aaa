#include "logs/report/html_parts.h"

#include "logs/report/svg_plot.h"

#include <fmt/format.h>

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

namespace waymark {
namespace {

std::string Row(const char* tag, const std::vector<Cell>& cells) {
  std::string row = "<tr>";
  for (const Cell& cell : cells) {
    row += cell.style.empty()
               ? fmt::format("<{}>", tag)
               : fmt::format("<{} class=\"{}\">", tag, cell.style);
    row += EscapeHtml(cell.text) + fmt::format("</{}>", tag);
  }
  return row + "</tr>\n";
}

std::string Base64(std::span<const std::uint8_t> bytes) {
  constexpr std::string_view kDigits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve(4 * (bytes.size() / 3 + 1));
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t bits = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      bits = bits << 8 | (i + k < bytes.size() ? bytes[i + k] : 0U);
    }
    for (std::size_t k = 0; k < 4; ++k) {
      const bool is_there = i + k <= bytes.size();
      text += is_there ? kDigits[bits >> (18 - 6 * k) & 63U] : '=';
    }
  }
  return text;
}

}  // namespace

std::string HtmlTable(const std::vector<std::vector<Cell>>& rows) {
  std::string table = "<div class=\"scroll\"><table>\n<thead>" +
                      Row("th", rows.front()) + "</thead>\n<tbody>";
  for (std::size_t i = 1; i < rows.size(); ++i) table += Row("td", rows[i]);
  return table + "</tbody></table></div>\n";
}

std::string HtmlFigure(const std::string& caption, const ImageFile& file) {
  const std::string text = EscapeHtml(caption);
  return "<figure>\n<figcaption>" + text + "</figcaption>\n<img alt=\"" + text +
         "\" src=\"data:image/" + (file.extension == ".png" ? "png" : "jpeg") +
         ";base64," + Base64(file.bytes) + "\"/>\n</figure>\n";
}

}  // namespace waymark
