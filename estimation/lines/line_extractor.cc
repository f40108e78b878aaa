#include "estimation/lines/line_extractor.h"

#include "estimation/lines/line_fit.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <stdexcept>

namespace waymark {

void LineExtractorOptions::Check() const {
  edges.Check();
  hough.Check();
  chains.Check();
  merger.Check();
  if (!(max_distance_px > 0.0) || !(max_distance_px <= 5.0)) {
    throw std::invalid_argument("max_distance_px must be in (0, 5]");
  }
  if (!(min_support > 0.0) || !(min_support <= 1.0)) {
    throw std::invalid_argument("min_support must be in (0, 1]");
  }
}

LineExtractor::LineExtractor(const LineExtractorOptions& options)
    : options_(options),
      detector_(options.edges),
      hough_(options.hough),
      chains_(options.chains),
      merger_(options.merger) {
  options.Check();
}

LineSet LineExtractor::Extract(const cv::Mat1b& image) {
  edges_ = &detector_.Detect(image);
  if (options_.scheme == LineScheme::kEdgeChains) {
    chains_.Find(*edges_, &parts_);
  } else {
    hough_.Find(*edges_, &parts_);
  }
  const LineSet coarse = merger_.Merge(parts_, image.cols, image.rows);
  LineSet set;
  set.has_polarity = true;
  set.segments.reserve(coarse.segments.size());
  set.pixels.reserve(coarse.pixels.size());
  for (const LineSegment& segment : coarse.segments) {
    Refine(coarse, segment, &set);
  }
  return set;
}

void LineExtractor::Refine(const LineSet& coarse,
                           const LineSegment& segment,
                           LineSet* set) {
  crests_.clear();
  LineMoments moments;
  double gradient_x = 0.0;
  double gradient_y = 0.0;
  for (std::int32_t i = 0; i < segment.num_pixels; ++i) {
    const Eigen::Vector2f& pixel =
        coarse.pixels[static_cast<std::size_t>(segment.first_pixel + i)];
    const int x = static_cast<int>(pixel.x());
    const int y = static_cast<int>(pixel.y());
    const std::size_t at = edges_->IndexOf(x, y);
    const int dx = edges_->dx[at];
    const int dy = edges_->dy[at];
    const float offset = edges_->CrestOffset(x, y);
    Eigen::Vector2f crest = pixel;
    (std::abs(dx) >= std::abs(dy) ? crest.x() : crest.y()) += offset;
    gradient_x += dx;
    gradient_y += dy;
    crests_.push_back(crest);
    moments.Add(static_cast<double>(crest.x()), static_cast<double>(crest.y()));
  }
  LineFit fit = moments.Fit();
  // Once more without what lies off the first line.
  const auto is_near = [&](const Eigen::Vector2f& p) {
    return std::abs(fit.Distance(p.cast<double>())) <= options_.max_distance_px;
  };
  moments = {};
  for (const Eigen::Vector2f& p : crests_) {
    if (!is_near(p)) continue;
    moments.Add(static_cast<double>(p.x()), static_cast<double>(p.y()));
  }
  if (moments.n < 2.0 ||
      moments.n < options_.min_support * segment.num_pixels) {
    return;
  }
  fit = moments.Fit();
  // The brighter side is on the right: (dy, -dx) leads from a to b.
  if (fit.direction.x() * gradient_y - fit.direction.y() * gradient_x < 0.0) {
    fit.direction = -fit.direction;
  }
  LineSegment refined;
  refined.first_pixel = static_cast<std::int32_t>(set->pixels.size());
  for (const Eigen::Vector2f& p : crests_) {
    if (is_near(p)) set->pixels.push_back(p);
  }
  const auto begin = set->pixels.begin() + refined.first_pixel;
  const auto by_place = [&](const Eigen::Vector2f& p,
                            const Eigen::Vector2f& q) {
    return fit.Along(p.cast<double>()) < fit.Along(q.cast<double>());
  };
  if (!std::is_sorted(begin, set->pixels.end(), by_place)) {
    std::stable_sort(begin, set->pixels.end(), by_place);
  }
  refined.num_pixels =
      static_cast<std::int32_t>(set->pixels.size()) - refined.first_pixel;
  const auto on_line = [&](const Eigen::Vector2f& p) -> Eigen::Vector2d {
    return fit.mean + fit.Along(p.cast<double>()) * fit.direction;
  };
  if (refined.num_pixels >= 2) {
    refined.a = on_line(*begin);
    refined.b = on_line(set->pixels.back());
  }
  if ((refined.b - refined.a).norm() < options_.merger.min_length_px) {
    set->pixels.resize(static_cast<std::size_t>(refined.first_pixel));
    return;
  }
  SetSegmentErrors(fit.across, (refined.b - refined.a).norm(), &refined);
  set->segments.push_back(refined);
}

}  // namespace waymark
