#include "logs/report/svg_plot.h"

#include "logs/report/plot_axis.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <regex>

namespace waymark {
namespace {

using testing::HasSubstr;
using testing::Not;

// End points of the first line: "M x y L x y ...".
std::vector<PlotPoint> LinePoints(const std::string& svg) {
  // A regular expression finds where the path begins, but does not match the
  // whole of it: std::regex recurses once for each character.
  const std::regex path("class=\"line [a-z ]*\" d=\"M");
  std::smatch match;
  std::vector<PlotPoint> points;
  // The legend's sample comes first.
  std::string rest = svg.substr(
      svg.find("</ul>") == std::string::npos ? 0 : svg.find("</ul>"));
  if (!std::regex_search(rest, match, path)) return points;
  const std::string suffix = match.suffix();
  const std::string text = "M" + suffix.substr(0, suffix.find('"'));
  const std::regex number("[ML]([-0-9.]+) ([-0-9.]+)");
  for (std::sregex_iterator i(text.begin(), text.end(), number), end; i != end;
       ++i) {
    points.push_back({std::stod((*i)[1]), std::stod((*i)[2])});
  }
  return points;
}

Plot LineThrough(std::vector<PlotPoint> points) {
  Plot plot;
  plot.title = "t";
  plot.series.push_back(
      {"a", "raw", PlotSeries::Style::kLine, std::move(points), {}});
  return plot;
}

TEST(PlotAxis, TicksAreRoundAndInside) {
  const PlotAxis axis(0.13, 9.7, false, 6);
  std::vector<std::string> texts;
  for (const auto& tick : axis.ticks()) texts.push_back(tick.text);
  EXPECT_THAT(texts, testing::ElementsAre("2", "4", "6", "8"));
  const PlotAxis fine(-0.01, 0.021, false, 6);
  EXPECT_EQ(fine.ticks()[0].text, "-0.01");
  EXPECT_EQ(fine.ticks()[1].text, "0.00");
  EXPECT_DOUBLE_EQ(axis.Place(0.13), 0.0);
  EXPECT_DOUBLE_EQ(axis.Place(9.7), 1.0);
}

TEST(PlotAxis, LogCoversWholeDecades) {
  const PlotAxis axis(0.3, 732.0, true, 6);
  EXPECT_DOUBLE_EQ(axis.low(), 0.1);
  EXPECT_DOUBLE_EQ(axis.high(), 1000.0);
  EXPECT_NEAR(axis.Place(10.0), 0.5, 1e-12);
  EXPECT_EQ(axis.ticks().size(), 5u);
  EXPECT_EQ(axis.ticks()[0].text, "0.1");
}

TEST(PlotAxis, OneValueStillHasARange) {
  EXPECT_NEAR(PlotAxis(5, 5, false, 6).Place(5), 0.5, 1e-12);
  EXPECT_NEAR(PlotAxis(0, 0, false, 6).Place(0), 0.5, 1e-12);
  EXPECT_GE(PlotAxis(1, 1, true, 6).ticks().size(), 2u);
}

TEST(Figure, UpIsUpAndRightIsRight) {
  const auto points = LinePoints(FigureOf(LineThrough({{0, 0}, {10, 5}})));
  ASSERT_EQ(points.size(), 2u);
  EXPECT_GT(points[1].x, points[0].x);
  EXPECT_LT(points[1].y, points[0].y);  // SVG counts downward.
}

TEST(Figure, EqualAspectKeepsShapes) {
  Plot plot = LineThrough({{0, 0}, {1, 0}, {1, 1}});
  plot.has_equal_aspect = true;
  const auto points = LinePoints(FigureOf(plot));
  ASSERT_EQ(points.size(), 3u);
  // Coordinates are printed to 0.1.
  EXPECT_NEAR(points[1].x - points[0].x, points[1].y - points[2].y, 0.11);
  EXPECT_GT(points[1].x - points[0].x, 100.0);
}

TEST(Figure, NotFiniteBreaksTheLineAndNothingElse) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::string svg =
      FigureOf(LineThrough({{0, 0}, {1, 1}, {nan, nan}, {2, 0}, {3, 1}}));
  EXPECT_EQ(LinePoints(svg).size(), 4u);
  EXPECT_THAT(svg, Not(HasSubstr("nan")));
  EXPECT_THAT(FigureOf(LineThrough({{nan, 1}})), HasSubstr("no data"));
  EXPECT_THAT(FigureOf(LineThrough({})), HasSubstr("no data"));
}

TEST(Figure, ThinningKeepsExtremes) {
  std::vector<PlotPoint> points;
  for (int i = 0; i < 100000; ++i) points.push_back({1.0 * i, std::sin(i)});
  points[77777].y = 50;
  const std::string svg = FigureOf(LineThrough(points));
  EXPECT_LT(svg.size(), 60000u);
  // The spike reaches the top, 4 % below the frame's edge at 8.
  const auto drawn = LinePoints(svg);
  const auto top = std::min_element(
      drawn.begin(), drawn.end(), [](const auto& a, const auto& b) {
        return a.y < b.y;
      });
  EXPECT_LT(top->y, 25.0);
}

TEST(Figure, EscapesTextOfOthers) {
  Plot plot = LineThrough({{0, 0}, {1, 1}});
  plot.title = "a<b> & \"c\"\x01";
  EXPECT_THAT(FigureOf(plot),
              HasSubstr("<figcaption>a&lt;b&gt; &amp; &quot;c&quot;</fig"));
}

}  // namespace
}  // namespace waymark
