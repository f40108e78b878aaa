#include "logs/report/svg_plot.h"

#include "logs/report/plot_axis.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace waymark {
namespace {

// Drawing units; the page scales them. Room for labels left and below.
constexpr double kWidth = 520.0;
constexpr double kLeft = 68.0;
constexpr double kRight = 12.0;
constexpr double kTop = 8.0;
constexpr double kBottom = 42.0;

bool IsFinite(const PlotPoint& p) {
  return std::isfinite(p.x) && std::isfinite(p.y);
}

struct Extent {
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();
  void Add(double value) {
    low = std::min(low, value);
    high = std::max(high, value);
  }
  [[nodiscard]] bool is_empty() const { return low > high; }
  // Lines shall not lie on the frame.
  void Widen() {
    const double margin = 0.04 * (high - low);
    low -= margin;
    high += margin;
  }
};

// Keeps what 520 units can show: of each of many short runs the extremes.
std::vector<std::size_t> VisibleIndices(const std::vector<PlotPoint>& points) {
  constexpr std::size_t kMaxRuns = 700;
  std::vector<std::size_t> kept;
  const std::size_t run = points.size() / kMaxRuns + 1;
  // Up to four kept of each run: shorter runs would grow.
  if (run <= 4) {
    for (std::size_t i = 0; i < points.size(); ++i) kept.push_back(i);
    return kept;
  }
  for (std::size_t begin = 0; begin < points.size(); begin += run) {
    const std::size_t end = std::min(begin + run, points.size());
    std::vector<std::size_t> chosen{begin, end - 1};
    std::size_t low = begin;
    std::size_t high = begin;
    for (std::size_t i = begin; i < end; ++i) {
      if (!IsFinite(points[i])) chosen.push_back(i);  // A break stays one.
      if (points[i].y < points[low].y) low = i;
      if (points[i].y > points[high].y) high = i;
    }
    chosen.push_back(low);
    chosen.push_back(high);
    std::sort(chosen.begin(), chosen.end());
    chosen.erase(std::unique(chosen.begin(), chosen.end()), chosen.end());
    kept.insert(kept.end(), chosen.begin(), chosen.end());
  }
  return kept;
}

class Drawing {
 public:
  explicit Drawing(const Plot& plot) : plot_(plot) {}

  std::string Draw() {
    if (!Prepare()) return "<p class=\"nodata\">no data</p>\n";
    std::string svg = fmt::format(
        "<svg viewBox=\"0 0 {:g} {}\" role=\"img\" aria-label=\"{}\">\n",
        kWidth,
        plot_.height,
        EscapeHtml(plot_.title));
    DrawBands(&svg);
    DrawAxes(&svg);
    // An inner drawing cuts off what leaves the frame.
    svg += fmt::format(
        "<svg x=\"{0:g}\" y=\"{1:g}\" width=\"{2:g}\" height=\"{3:g}\" "
        "viewBox=\"{0:g} {1:g} {2:g} {3:g}\">\n",
        kLeft,
        kTop,
        inner_width(),
        inner_height());
    for (const PlotSeries& series : plot_.series) DrawHalo(series, &svg);
    for (const PlotSeries& series : plot_.series) DrawSeries(series, &svg);
    return svg + "</svg>\n</svg>\n";
  }

 private:
  bool Prepare() {
    Extent x;
    Extent y;
    for (const PlotSeries& series : plot_.series) {
      for (std::size_t i = 0; i < series.points.size(); ++i) {
        const PlotPoint& p = series.points[i];
        if (!IsFinite(p)) continue;
        x.Add(p.x);
        y.Add(Floored(p.y));
        // Bands often start far wider than what follows; from three quarters
        // on they shall be seen whole.
        if (series.half_width.empty() || 4 * i < 3 * series.points.size()) {
          continue;
        }
        y.Add(Floored(p.y - series.half_width[i]));
        y.Add(Floored(p.y + series.half_width[i]));
      }
    }
    if (x.is_empty() || y.is_empty()) return false;
    for (const PlotBand& band : plot_.bands) {
      y.Add(Floored(band.low));
      y.Add(Floored(band.high));
    }
    if (!plot_.is_log_y) y.Widen();
    if (plot_.has_equal_aspect) {
      x.Widen();
      MakeEqual(&x, &y);
    }
    constexpr int kTicksAcross = 7;
    constexpr int kTicksUp = 6;
    x_.emplace(x.low, x.high, false, kTicksAcross);
    y_.emplace(y.low, y.high, plot_.is_log_y, kTicksUp);
    return true;
  }

  // Widens the narrower range until one unit is as long on both axes.
  void MakeEqual(Extent* x, Extent* y) const {
    const double per_unit = std::max((x->high - x->low) / inner_width(),
                                     (y->high - y->low) / inner_height());
    // A robot that never moved still gets a scale.
    const double scale = per_unit > 0.0 ? per_unit : 1.0 / inner_width();
    const auto stretch = [](Extent* e, double length) {
      const double middle = 0.5 * (e->low + e->high);
      e->low = middle - 0.5 * length;
      e->high = middle + 0.5 * length;
    };
    stretch(x, scale * inner_width());
    stretch(y, scale * inner_height());
  }

  [[nodiscard]] double inner_width() const { return kWidth - kLeft - kRight; }
  [[nodiscard]] double inner_height() const {
    return plot_.height - kTop - kBottom;
  }
  [[nodiscard]] double Floored(double value) const {
    return plot_.is_log_y ? std::max(value, plot_.y_floor) : value;
  }
  [[nodiscard]] double X(double value) const {
    return kLeft + inner_width() * x_->Place(value);
  }
  [[nodiscard]] double Y(double value) const {
    return kTop + inner_height() * (1.0 - y_->Place(Floored(value)));
  }

  void DrawBands(std::string* svg) const {
    for (const PlotBand& band : plot_.bands) {
      *svg += fmt::format(
          "<rect class=\"band\" x=\"{:g}\" y=\"{:.1f}\" width=\"{:g}\" "
          "height=\"{:.1f}\"/>\n",
          kLeft,
          Y(band.high),
          inner_width(),
          Y(band.low) - Y(band.high));
    }
  }

  void DrawAxes(std::string* svg) const {
    const double bottom = plot_.height - kBottom;
    const double right = kWidth - kRight;
    for (const PlotAxis::Tick& tick : x_->ticks()) {
      const double x = X(tick.value);
      *svg += fmt::format(
          "<line class=\"grid\" x1=\"{0:.1f}\" x2=\"{0:.1f}\" y1=\"{1:g}\" "
          "y2=\"{2:g}\"/><text class=\"tick\" x=\"{0:.1f}\" y=\"{3:g}\" "
          "text-anchor=\"middle\">{4}</text>\n",
          x,
          kTop,
          bottom,
          bottom + 15.0,
          tick.text);
    }
    for (const PlotAxis::Tick& tick : y_->ticks()) {
      const double y = Y(tick.value);
      *svg += fmt::format(
          "<line class=\"grid\" x1=\"{1:g}\" x2=\"{2:g}\" y1=\"{0:.1f}\" "
          "y2=\"{0:.1f}\"/><text class=\"tick\" x=\"{3:g}\" y=\"{4:.1f}\" "
          "text-anchor=\"end\">{5}</text>\n",
          y,
          kLeft,
          right,
          kLeft - 6.0,
          y + 4.0,
          tick.text);
    }
    *svg += fmt::format(
        "<rect class=\"frame\" x=\"{:g}\" y=\"{:g}\" width=\"{:g}\" "
        "height=\"{:g}\"/>\n",
        kLeft,
        kTop,
        inner_width(),
        inner_height());
    const double middle = kTop + 0.5 * inner_height();
    *svg += fmt::format(
        "<text class=\"label\" x=\"{:g}\" y=\"{:g}\" "
        "text-anchor=\"middle\">{}</text>\n"
        "<text class=\"label\" x=\"13\" y=\"{:g}\" text-anchor=\"middle\" "
        "transform=\"rotate(-90 13 {:g})\">{}</text>\n",
        kLeft + 0.5 * inner_width(),
        plot_.height - 8.0,
        EscapeHtml(plot_.x_label),
        middle,
        middle,
        EscapeHtml(plot_.y_label));
  }

  void DrawHalo(const PlotSeries& series, std::string* svg) const {
    if (series.half_width.empty()) return;
    std::string upper;
    std::string lower;
    const auto indices = VisibleIndices(series.points);
    for (const std::size_t i : indices) {
      const PlotPoint& p = series.points[i];
      if (!IsFinite(p) || !std::isfinite(series.half_width[i])) continue;
      upper +=
          fmt::format("{:.1f},{:.1f} ", X(p.x), Y(p.y + series.half_width[i]));
      lower.insert(
          0,
          fmt::format("{:.1f},{:.1f} ", X(p.x), Y(p.y - series.half_width[i])));
    }
    *svg += fmt::format("<polygon class=\"halo {}\" points=\"{}\"/>\n",
                        series.role,
                        upper + lower);
  }

  void DrawSeries(const PlotSeries& series, std::string* svg) const {
    if (series.style == PlotSeries::Style::kDots) {
      for (const std::size_t i : VisibleIndices(series.points)) {
        const PlotPoint& p = series.points[i];
        if (!IsFinite(p)) continue;
        *svg += fmt::format(
            "<circle class=\"dot {}\" cx=\"{:.1f}\" cy=\"{:.1f}\" "
            "r=\"2.2\"/>\n",
            series.role,
            X(p.x),
            Y(p.y));
      }
      return;
    }
    std::string path;
    bool is_down = false;
    PlotPoint last;
    for (const std::size_t i : VisibleIndices(series.points)) {
      if (!IsFinite(series.points[i])) {
        is_down = false;
        continue;
      }
      const PlotPoint p{X(series.points[i].x), Y(series.points[i].y)};
      // Nothing smaller than a third of a unit can be seen.
      constexpr double kSmallest = 0.3;
      if (is_down && std::hypot(p.x - last.x, p.y - last.y) < kSmallest) {
        continue;
      }
      path += fmt::format("{}{:.1f} {:.1f}", is_down ? "L" : "M", p.x, p.y);
      is_down = true;
      last = p;
    }
    *svg +=
        fmt::format("<path class=\"line {}{}\" d=\"{}\"/>\n",
                    series.role,
                    series.style == PlotSeries::Style::kDashed ? " dashed" : "",
                    path);
  }

  const Plot& plot_;
  std::optional<PlotAxis> x_;
  std::optional<PlotAxis> y_;
};

std::string LegendOf(const Plot& plot) {
  std::string legend = "<ul class=\"legend\">";
  for (const PlotSeries& series : plot.series) {
    if (series.label.empty() || series.points.empty()) continue;
    const bool is_dots = series.style == PlotSeries::Style::kDots;
    const char* sample =
        is_dots ? "<circle class=\"dot {0}\" cx=\"11\" cy=\"5\" r=\"3\"/>"
                : "<path class=\"line {0}\" d=\"M0 5L22 5\"/>";
    std::string role = series.role;
    if (series.style == PlotSeries::Style::kDashed) role += " dashed";
    legend += "<li><svg viewBox=\"0 0 22 10\">" +
              fmt::format(fmt::runtime(sample), role) + "</svg>" +
              EscapeHtml(series.label) + "</li>";
  }
  for (const PlotBand& band : plot.bands) {
    legend +=
        "<li><svg viewBox=\"0 0 22 10\"><rect class=\"band\" x=\"0\" y=\"0\" "
        "width=\"22\" height=\"10\"/></svg>" +
        EscapeHtml(band.label) + "</li>";
  }
  // A list needs an entry.
  return legend.ends_with("</li>") ? legend + "</ul>\n" : std::string();
}

}  // namespace

std::string FigureOf(const Plot& plot) {
  return "<figure>\n<figcaption>" + EscapeHtml(plot.title) + "</figcaption>\n" +
         LegendOf(plot) + Drawing(plot).Draw() + "</figure>\n";
}

std::string EscapeHtml(const std::string& text) {
  std::string result;
  for (const char c : text) {
    switch (c) {
      case '&':
        result += "&amp;";
        break;
      case '<':
        result += "&lt;";
        break;
      case '>':
        result += "&gt;";
        break;
      case '"':
        result += "&quot;";
        break;
      default:
        if (static_cast<unsigned char>(c) >= 0x20 || c == '\n' || c == '\t') {
          result += c;
        }
    }
  }
  return result;
}

}  // namespace waymark
