// From pixels of a small image to the place in a corridor: whatever the image,
// the camera's mounting, the corridor and what was believed before, lines are
// finite, and so is every answer.
#include "estimation/corridor/corridor_tracker.h"
#include "estimation/corridor/edge_evidence.h"
#include "estimation/geometry/angle.h"
#include "estimation/lines/line_extractor.h"
#include "estimation/lines/manhattan_directions.h"
#include "estimation/lines/vanishing_point.h"
#include "tests/fuzz/fuzz_target.h"

#include <opencv2/core.hpp>

#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <stdexcept>
#include <tuple>
#include <utility>

namespace waymark::fuzz {
namespace {

class Reader {
 public:
  explicit Reader(Bytes data) : data_(data) {}

  [[nodiscard]] bool is_empty() const { return data_.empty(); }
  [[nodiscard]] Bytes rest() const { return data_; }
  int Byte() {
    if (data_.empty()) return 0;
    const int value = data_.front();
    data_ = data_.subspan(1);
    return value;
  }
  // Evenly spread, 128 in the middle.
  double Around(double middle, double reach) {
    return middle + reach * (Byte() - 128) / 128.0;
  }
  // The same, but for the last bytes: what no caller should give.
  double Wild(double middle, double reach) {
    constexpr double kInf = std::numeric_limits<double>::infinity();
    constexpr std::array kOdd = {std::numeric_limits<double>::quiet_NaN(),
                                 kInf,
                                 -kInf,
                                 1e300,
                                 -1e300,
                                 1e9,
                                 1e-300,
                                 0.0};
    const int byte = Byte();
    return byte >= 248 ? kOdd[static_cast<std::size_t>(byte - 248)]
                       : middle + reach * (byte - 128) / 128.0;
  }

 private:
  Bytes data_;
};

CorridorGeometry CorridorFrom(Reader* reader) {
  CorridorGeometry corridor;
  const int known = reader->Byte();
  if ((known & 1) != 0) corridor.width = std::exp(reader->Around(1.3, 2.5));
  if ((known & 2) != 0) corridor.height = std::exp(reader->Around(1.3, 2.0));
  if ((known & 4) != 0) {
    corridor.skirting_height = std::exp(reader->Around(-2.5, 2.5));
    corridor.skirting_depth = reader->Around(0.05, 0.05);
  }
  if ((known & 8) != 0) {
    corridor.x_min = reader->Around(0.0, 10.0);
    corridor.x_max = corridor.x_min + 1e-6 + reader->Byte();
  }
  return corridor;
}

std::optional<CorridorPrior> PriorFrom(Reader* reader) {
  const int known = reader->Byte();
  if ((known & 1) == 0) return std::nullopt;
  CorridorPrior prior;
  prior.X_LR = {
      reader->Wild(5.0, 5.0), reader->Wild(0.0, 1.0), reader->Wild(0.0, 3.2)};
  for (int i = 0; i < 3; ++i) {
    const double sigma = reader->Wild(0.13, 0.13);
    prior.covariance(i, i) = (known & 2) != 0 ? sigma : sigma * sigma;
  }
  if ((known & 4) != 0) prior.covariance(1, 2) = reader->Wild(0.0, 0.01);
  return prior;
}

// Looking ahead, at a height and tilt of its own.
Eigen::Isometry3d MountingFrom(Reader* reader) {
  Eigen::Matrix3d ahead;
  ahead << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  Eigen::Isometry3d X_RC = Eigen::Isometry3d::Identity();
  X_RC.translation() << 0.1, 0.0, reader->Around(0.7, 0.7);
  const double pan = reader->Around(0.0, kPi);
  const double tilt = reader->Around(0.0, kPi);
  X_RC.linear() = (Eigen::AngleAxisd(pan, Eigen::Vector3d::UnitZ()) *
                   Eigen::AngleAxisd(tilt, Eigen::Vector3d::UnitY()))
                      .toRotationMatrix() *
                  ahead;
  return X_RC;
}

CorridorView ViewFrom(Reader* reader) {
  CorridorView view;
  const double f = std::exp(reader->Around(5.0, 2.0));
  view.size = {640, 480};
  view.intrinsics = {f, f, 319.5, 239.5};
  view.X_RC = MountingFrom(reader);
  return view;
}

// Edges of the corridor as they would be seen from somewhere, and other lines;
// five bytes each.
void AddLines(const CorridorView& view,
              const CorridorGeometry& corridor,
              double y,
              double heading,
              Reader* reader,
              LineSet* set) {
  for (int i = reader->Byte() % 64; i > 0 && !reader->is_empty(); --i) {
    const int kind = reader->Byte();
    LineSegment line;
    line.a = {reader->Around(319.5, 320.0), reader->Around(239.5, 240.0)};
    line.b = {reader->Around(319.5, 320.0), reader->Around(239.5, 240.0)};
    line.sigma_px = 0.02 + 0.05 * (kind >> 4);
    line.sigma_rad = 0.1 * line.sigma_px;
    const auto place = PlaceOf(static_cast<CorridorEdge>(kind & 7), corridor);
    if (place && (kind & 8) != 0) {
      const double from = line.a.x() / 50.0 - 2.0;
      const auto ends = VisibleEdge(
          view, *place, y, heading, from, from + 1e-3 + line.a.y() / 50.0);
      if (ends) std::tie(line.a, line.b) = *ends;
    }
    // Two ends, as LineSegment has it.
    if ((line.b - line.a).norm() < 1e-6) continue;
    set->segments.push_back(line);
  }
}

cv::Mat1b ImageFrom(int width, int height, Bytes pixels) {
  cv::Mat1b image(height, width, std::uint8_t{0});
  if (pixels.empty()) return image;
  std::size_t i = 0;
  for (std::uint8_t& pixel : image) {
    pixel = pixels[i];
    if (++i == pixels.size()) i = 0;
  }
  return image;
}

void CheckLines(const LineSet& set, const cv::Size& size) {
  for (const LineSegment& line : set.segments) {
    Expect(line.a.allFinite() && line.b.allFinite(), "ends are finite");
    Expect(line.a != line.b, "a line has two ends");
    for (const Eigen::Vector2d& end : {line.a, line.b}) {
      Expect(end.x() > -2.0 && end.x() < size.width + 1.0 && end.y() > -2.0 &&
                 end.y() < size.height + 1.0,
             "lines are in the image");
    }
    Expect(line.sigma_px > 0.0 && std::isfinite(line.sigma_px) &&
               line.sigma_rad > 0.0 && std::isfinite(line.sigma_rad),
           "errors are positive");
    Expect(line.first_pixel >= 0 && line.num_pixels > 0 &&
               static_cast<std::size_t>(line.first_pixel) +
                       static_cast<std::size_t>(line.num_pixels) <=
                   set.pixels.size(),
           "supporting pixels are there");
  }
}

LineSet LinesOf(LineScheme scheme, const cv::Mat1b& image) {
  LineExtractorOptions options;
  options.scheme = scheme;
  // One after another: the buffers of the one before must not matter.
  LineExtractor extractor(options);
  const LineSet set = extractor.Extract(image);
  CheckLines(set, image.size());
  const cv::Mat1b turned = image.empty() ? image : cv::Mat1b(image.t());
  CheckLines(extractor.Extract(turned), turned.size());
  Expect(extractor.Extract(image).segments.size() == set.segments.size(),
         "the same image has the same lines");
  return set;
}

void CheckDirections(const LineSet& set,
                     const CorridorView& view,
                     const std::optional<CorridorPrior>& prior) {
  const Intrinsics& k = view.intrinsics;
  const PinholeView pinhole{k.fx, k.fy, k.cx, k.cy};
  const Eigen::Vector3d gravity_C =
      -view.X_RC.linear().transpose().col(2).normalized();
  std::optional<HeadingPrior> heading;
  if (prior && std::abs(prior->X_LR.heading) < 10.0) {
    heading = HeadingPrior{prior->X_LR.heading, 0.1};
  }
  for (const HorizontalDirection& direction : FindHorizontalDirections(
           set.segments, pinhole, gravity_C, heading, {})) {
    Expect(direction.n_C.allFinite() && std::isfinite(direction.heading) &&
               std::isfinite(direction.sigma_rad),
           "directions are finite");
    Expect(direction.inlier_mask.size() == set.segments.size(),
           "a mark for each line");
  }
  for (const auto& gravity :
       {std::optional<DirectionPrior>(),
        std::optional<DirectionPrior>({gravity_C, 0.01})}) {
    const ManhattanReport report =
        FindManhattanDirections(set.segments, pinhole, gravity, {});
    Expect(report.directions || !report.reason.empty(), "a reason");
    if (!report.directions) continue;
    const Eigen::Matrix3d& R = report.directions->R_CM;
    Expect((R.transpose() * R - Eigen::Matrix3d::Identity()).norm() < 1e-6,
           "axes are a rotation");
    Expect(report.directions->covariance.allFinite(), "errors are finite");
  }
}

void CheckEstimate(const CorridorEstimate& estimate,
                   const CorridorGeometry& corridor,
                   const LineSet& set) {
  Expect(estimate.lines.size() == set.segments.size(), "all lines, in order");
  const bool is_accepted = estimate.status == CorridorStatus::kAccepted;
  Expect(is_accepted == estimate.reason.empty(), "a reason, or accepted");
  Expect(!is_accepted || (estimate.y && estimate.heading), "a pose");
  Expect(!estimate.y || (estimate.heading && corridor.width),
         "a position needs heading and width");
  Expect(estimate.p_regular >= 0.0 && estimate.p_regular <= 1.0,
         "a probability");
  Expect(estimate.covariance.allFinite(), "errors are finite");
  if (estimate.vanishing_point) {
    Expect(estimate.vanishing_point->allFinite(), "a vanishing point");
  }
  if (estimate.heading) {
    Expect(std::abs(*estimate.heading) <= kPi, "a heading is in (-pi, pi]");
    Expect(estimate.covariance(1, 1) > 0.0, "a heading has an error");
  }
  if (estimate.y) {
    Expect(std::isfinite(*estimate.y), "a position is finite");
    Expect(estimate.covariance.determinant() > 0.0, "its errors are known");
  }
}

}  // namespace

// Camera, corridor, prior, lines, then width and height of an image and its
// pixels, over and over.
void RunOne(Bytes data) {
  Reader reader(data);
  const CorridorView view = ViewFrom(&reader);
  const CorridorGeometry corridor = CorridorFrom(&reader);
  try {
    corridor.Check();
  } catch (const std::invalid_argument&) {
    return;
  }
  const std::optional<CorridorPrior> prior = PriorFrom(&reader);
  const double y = reader.Around(0.0, 1.0);
  const double heading = reader.Around(0.0, kPi);
  LineSet given;
  AddLines(view, corridor, y, heading, &reader, &given);
  const int width = reader.Byte() % 65;
  const int height = reader.Byte() % 65;
  const cv::Mat1b image = ImageFrom(width, height, reader.rest());
  const LineSet hough = LinesOf(LineScheme::kSegmentedHough, image);
  const LineSet chains = LinesOf(LineScheme::kEdgeChains, image);
  for (const LineSet* set : {&std::as_const(given), &hough, &chains}) {
    CheckDirections(*set, view, prior);
    for (const CorridorMethod method :
         {CorridorMethod::kJoint, CorridorMethod::kPaper}) {
      CorridorTrackerOptions options;
      options.method = method;
      CheckEstimate(EstimateCorridor(view, *set, corridor, prior, options),
                    corridor,
                    *set);
    }
  }
}

std::vector<std::string> Seeds() {
  // Focal length, height, pan and tilt; corridor; prior; pose.
  const std::string camera = "\xa0\x80\x80\x88";
  const std::string corridor = "\x07\x70\x70\x80\x80";
  const std::string prior = "\x01\x80\x80\x80\x80\x80\x80";
  const std::string pose = "\x88\x82";
  std::string lines = "\x10";
  for (int i = 0; i < 16; ++i) {
    lines += static_cast<char>(8 + 1 + i % 6);
    lines += static_cast<char>(60 + 3 * i);
    lines += static_cast<char>(200 - 2 * i);
    lines += static_cast<char>(5 * i);
    lines += static_cast<char>(255 - 5 * i);
  }
  const std::string stripes =
      "\x40\x30" + std::string(9, '\x20') + std::string(8, '\xd0');
  std::string noise = "\x21\x3f";
  for (int i = 0; i < 60; ++i) {
    noise += static_cast<char>(i * i * 37 + i);
  }
  const std::string blank("\0\0\0", 3);
  // Few and short: each is mutated thousands of times.
  return {camera + corridor + prior + pose + lines + blank,
          camera + corridor + prior + pose + std::string(1, '\0') + noise,
          camera + corridor + prior + pose + std::string(1, '\0') + stripes};
}

}  // namespace waymark::fuzz
