// Line plots as inline SVG for a page that opens offline: no scripts, no
// fonts, no links. Colours come from the page's style sheet.
#pragma once

#include <string>
#include <vector>

namespace waymark {

struct PlotPoint {
  double x = 0.0;
  double y = 0.0;
};

struct PlotSeries {
  enum class Style { kLine, kDashed, kDots };
  std::string label;  // In the legend; empty: not there.
  std::string role;   // Style class that gives the colour: "truth", "raw", ...
  Style style = Style::kLine;
  // In data units, drawn in order; a point that is not finite breaks the line.
  std::vector<PlotPoint> points;
  // Shaded band about the line: empty, or for each point the half width.
  std::vector<double> half_width;
};

// A shaded horizontal stretch, such as a 95 % band.
struct PlotBand {
  double low = 0.0;
  double high = 0.0;
  std::string label;
};

struct Plot {
  std::string title;
  std::string x_label;  // With unit.
  std::string y_label;
  bool has_equal_aspect = false;  // One metre is as long on both axes.
  bool is_log_y = false;          // Values below y_floor are drawn at it.
  double y_floor = 1e-3;          // Used where is_log_y.
  int height = 320;               // Of the drawing; its width is 520.
  std::vector<PlotSeries> series;
  std::vector<PlotBand> bands;
};

// A <figure> with title, legend and drawing, well-formed as XML. Series with
// many points are thinned to what can be seen: extremes stay. A plot without
// a finite point says "no data".
[[nodiscard]] std::string FigureOf(const Plot& plot);

// Text for HTML: & < > " escaped, control characters dropped.
[[nodiscard]] std::string EscapeHtml(const std::string& text);

}  // namespace waymark
