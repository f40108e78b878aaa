#include "estimation/lines/vanishing_point.h"

#include "estimation/base/random.h"
#include "estimation/geometry/angle.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

namespace waymark {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr PinholeView kView{400.0, 420.0, 318.0, 243.0};

Vector2d Pixel(const Vector3d& p_C) {
  return {kView.fx * p_C.x() / p_C.z() + kView.cx,
          kView.fy * p_C.y() / p_C.z() + kView.cy};
}

// Where gravity pulls, for a camera tilted down and then rolled.
Vector3d Gravity(double tilt, double roll) {
  return Eigen::AngleAxisd(roll, Vector3d::UnitZ()) *
         (Eigen::AngleAxisd(tilt, -Vector3d::UnitX()) * Vector3d::UnitY())
             .eval();
}

// Visible edges along n_C, each through a point in front of the camera; their
// ends and directions carry the stated errors times `noise`.
std::vector<LineSegment> EdgesAlong(const Vector3d& n_C,
                                    int num,
                                    double noise,
                                    Random* random) {
  constexpr double kSigmaPx = 0.2;
  constexpr double kSigmaRad = 0.003;
  std::vector<LineSegment> lines;
  while (static_cast<int>(lines.size()) < num) {
    const Vector3d middle(random->Uniform(-3.0, 3.0),
                          random->Uniform(-2.0, 2.0),
                          random->Uniform(3.0, 6.0));
    const Vector3d p = middle - 0.8 * n_C;
    const Vector3d q = middle + 0.8 * n_C;
    if (p.z() < 1.0 || q.z() < 1.0) continue;
    LineSegment line;
    const Vector2d a = Pixel(p);
    const Vector2d b = Pixel(q);
    // Shorter ones say little of a direction.
    if ((b - a).norm() < 30.0) continue;
    const Vector2d t = (b - a).normalized();
    const Vector2d across(-t.y(), t.x());
    const double offset = random->Normal(noise * kSigmaPx);
    const double turn = random->Normal(noise * kSigmaRad);
    const double half = 0.5 * (b - a).norm();
    line.a = a + across * (offset - half * turn);
    line.b = b + across * (offset + half * turn);
    line.sigma_px = kSigmaPx;
    line.sigma_rad = kSigmaRad;
    lines.push_back(line);
  }
  return lines;
}

std::vector<LineSegment> Mirrored(std::vector<LineSegment> lines) {
  for (LineSegment& line : lines) {
    line.a.x() = 2.0 * kView.cx - line.a.x();
    line.b.x() = 2.0 * kView.cx - line.b.x();
  }
  return lines;
}

double AxisAngle(const Vector3d& a, const Vector3d& b) {
  return std::atan2(a.cross(b).norm(), std::abs(a.dot(b)));
}

std::vector<HorizontalDirection> Find(
    const std::vector<LineSegment>& lines,
    const Vector3d& gravity_C,
    const std::optional<HeadingPrior>& prior = std::nullopt,
    HorizontalDirectionOptions options = {}) {
  return FindHorizontalDirections(lines, kView, gravity_C, prior, options);
}

TEST(Heading, OfATiltedCameraIsThePapers) {
  const double tilt = 0.3;
  const Vector3d gravity_C = Gravity(tilt, 0.0);
  for (const double heading : {-1.2, -0.4, 0.0, 0.1, 0.9}) {
    const Vector3d n_C = DirectionOfHeading(heading, gravity_C);
    EXPECT_NEAR(n_C.dot(gravity_C), 0.0, 1e-15);
    EXPECT_NEAR(HeadingOf(n_C, gravity_C), heading, 1e-12);
    const double x_v = n_C.x() / n_C.z();
    EXPECT_NEAR(std::atan(x_v * std::cos(tilt)), heading, 1e-12);
    // Positive to the right.
    EXPECT_EQ(heading > 0.0, x_v > 0.0);
  }
}

TEST(HorizontalDirection, ExactLinesGiveTheExactHeading) {
  Random random(SeedFor(1, "ExactLinesGiveTheExactHeading"));
  for (const double tilt : {-0.2, 0.0, 0.35}) {
    for (const double roll : {-0.1, 0.0, 0.2}) {
      for (int degrees = -80; degrees <= 90; degrees += 10) {
        SCOPED_TRACE(std::to_string(tilt) + ' ' + std::to_string(roll) + ' ' +
                     std::to_string(degrees));
        const Vector3d gravity_C = Gravity(tilt, roll);
        const double heading = RadiansFromDegrees(degrees);
        const Vector3d n_C = DirectionOfHeading(heading, gravity_C);
        const auto found = Find(EdgesAlong(n_C, 12, 0.0, &random), gravity_C);
        ASSERT_FALSE(found.empty());
        EXPECT_LT(AxisAngle(found[0].n_C, n_C), 1e-9);
        EXPECT_GE(found[0].num_inliers, 10);
      }
    }
  }
}

TEST(HorizontalDirection, MirroredLinesFlipTheHeading) {
  Random random(SeedFor(2, "MirroredLinesFlipTheHeading"));
  const Vector3d gravity_C = Gravity(0.2, 0.0);
  const auto lines =
      EdgesAlong(DirectionOfHeading(0.4, gravity_C), 20, 1.0, &random);
  const auto found = Find(lines, gravity_C);
  const auto flipped = Find(Mirrored(lines), gravity_C);
  ASSERT_FALSE(found.empty());
  ASSERT_FALSE(flipped.empty());
  EXPECT_NEAR(found[0].heading, -flipped[0].heading, 1e-9);
  EXPECT_GT(found[0].heading, 0.3);
}

TEST(HorizontalDirection, ErrorsAreThoseItStates) {
  Random random(SeedFor(3, "HorizontalDirection.ErrorsAreThoseItStates"));
  HorizontalDirectionOptions options;
  options.model_sigma_rad = 0.0;
  const Vector3d gravity_C = Gravity(0.1, -0.05);
  double sum = 0.0;
  constexpr int kRuns = 400;
  for (int i = 0; i < kRuns; ++i) {
    const double heading = random.Uniform(-0.6, 0.6);
    const auto lines =
        EdgesAlong(DirectionOfHeading(heading, gravity_C), 15, 1.0, &random);
    const auto found = Find(lines, gravity_C, std::nullopt, options);
    ASSERT_FALSE(found.empty());
    const double z = (found[0].heading - heading) / found[0].sigma_rad;
    sum += z * z;
  }
  // Four sigma of the mean of 400 squares about 1 are 0.28; lines in the tails
  // count for less than they know, which adds some.
  EXPECT_GT(sum / kRuns, 0.72);
  EXPECT_LT(sum / kRuns, 1.45);
}

TEST(HorizontalDirection, FindsAllAndThePriorChooses) {
  Random random(SeedFor(4, "FindsAllAndThePriorChooses"));
  const Vector3d gravity_C = Gravity(0.1, 0.0);
  auto lines = EdgesAlong(DirectionOfHeading(0.2, gravity_C), 20, 1.0, &random);
  const auto cross = EdgesAlong(
      DirectionOfHeading(0.2 - 0.5 * kPi, gravity_C), 10, 1.0, &random);
  const auto vertical = EdgesAlong(gravity_C, 30, 1.0, &random);
  lines.insert(lines.end(), cross.begin(), cross.end());
  lines.insert(lines.end(), vertical.begin(), vertical.end());
  const auto found = Find(lines, gravity_C);
  ASSERT_GE(found.size(), 2u);
  EXPECT_NEAR(found[0].heading, 0.2, 0.02);
  EXPECT_NEAR(found[1].heading, 0.2 - 0.5 * kPi, 0.02);
  const auto right = Find(lines, gravity_C, HeadingPrior{0.2 + 0.5 * kPi, 0.1});
  ASSERT_FALSE(right.empty());
  EXPECT_NEAR(right[0].heading, 0.2 + 0.5 * kPi, 0.02);
  // The other way along the same axis.
  const auto back = Find(lines, gravity_C, HeadingPrior{0.2 - kPi, 0.1});
  ASSERT_FALSE(back.empty());
  EXPECT_NEAR(back[0].heading, 0.2 - kPi, 0.02);
  EXPECT_LT(back[0].n_C.z(), 0.0);
}

TEST(HorizontalDirection, PiecesOfOneLineAreNoEvidence) {
  const Vector3d gravity_C = Gravity(0.0, 0.0);
  EXPECT_TRUE(Find({}, gravity_C).empty());
  std::vector<LineSegment> lines(1);
  lines[0].a = {100.0, 100.0};
  lines[0].b = {150.0, 130.0};
  EXPECT_TRUE(Find(lines, gravity_C).empty());
  lines.push_back(lines[0]);
  lines[1].a = {200.0, 160.0};
  lines[1].b = {250.0, 190.0};
  EXPECT_TRUE(Find(lines, gravity_C).empty());
}

TEST(VanishingPoint, ExactLinesGiveTheExactPoint) {
  Random random(SeedFor(5, "ExactLinesGiveTheExactPoint"));
  for (int pan = -90; pan <= 90; pan += 15) {
    for (int rise = -40; rise <= 40; rise += 20) {
      SCOPED_TRACE(std::to_string(pan) + ' ' + std::to_string(rise));
      const double a = RadiansFromDegrees(pan);
      const double b = RadiansFromDegrees(rise);
      const Vector3d n_C(
          std::sin(a) * std::cos(b), std::sin(b), std::cos(a) * std::cos(b));
      const auto lines = EdgesAlong(n_C, 10, 0.0, &random);
      const Vector3d off = (n_C + Vector3d(0.02, -0.03, 0.01)).normalized();
      const auto found = FindVanishingPoint(lines, kView, {off, 0.1}, {});
      ASSERT_TRUE(found.has_value());
      EXPECT_LT((found->n_C - n_C).norm(), 1e-9);
      EXPECT_EQ(found->num_inliers, 10);
    }
  }
}

TEST(VanishingPoint, ErrorsAreThoseItStates) {
  Random random(SeedFor(6, "VanishingPoint.ErrorsAreThoseItStates"));
  const Vector3d n_C = Vector3d(0.2, 0.1, 1.0).normalized();
  // All of them, so that the selection does not change the statistics.
  VanishingPointOptions options;
  options.num_kept = 10000;
  options.min_angle_rad = 0.2;
  double sum = 0.0;
  constexpr int kRuns = 400;
  for (int i = 0; i < kRuns; ++i) {
    const auto lines = EdgesAlong(n_C, 10, 1.0, &random);
    const auto found = FindVanishingPoint(lines, kView, {n_C, 0.2}, options);
    ASSERT_TRUE(found.has_value());
    const Vector2d e = found->across_C.transpose() * n_C;
    sum += e.dot(found->covariance.inverse() * e);
  }
  // Two degrees of freedom; four sigma of the mean are 0.4.
  EXPECT_NEAR(sum / kRuns, 2.0, 0.4);
}

TEST(VanishingPoint, OtherLinesDoNotMoveItFar) {
  Random random(SeedFor(7, "OtherLinesDoNotMoveItFar"));
  const Vector3d n_C = Vector3d(-0.15, 0.05, 1.0).normalized();
  auto lines = EdgesAlong(n_C, 12, 1.0, &random);
  const auto others = EdgesAlong(Vector3d::UnitY(), 6, 1.0, &random);
  lines.insert(lines.end(), others.begin(), others.end());
  const auto found = FindVanishingPoint(lines, kView, {n_C, 0.1}, {});
  ASSERT_TRUE(found.has_value());
  // The paper's figure: 0.3 degrees.
  EXPECT_LT(AxisAngle(found->n_C, n_C), 0.0053);
}

TEST(VanishingPoint, OfFewLinesThereIsNone) {
  Random random(SeedFor(8, "OfFewLinesThereIsNone"));
  const DirectionPrior prior;
  EXPECT_FALSE(FindVanishingPoint({}, kView, prior, {}).has_value());
  const auto one = EdgesAlong(Vector3d(0.1, 0.1, 1.0), 1, 0.0, &random);
  EXPECT_FALSE(FindVanishingPoint(one, kView, prior, {}).has_value());
}

TEST(VanishingPoint, RefusesWhatIsNoLine) {
  std::vector<LineSegment> lines(1);
  lines[0].b = {std::numeric_limits<double>::quiet_NaN(), 3.0};
  const Vector3d gravity_C = Vector3d::UnitY();
  EXPECT_THROW((void)FindVanishingPoint(lines, kView, {}, {}),
               std::logic_error);
  EXPECT_THROW((void)Find(lines, gravity_C), std::logic_error);
  lines[0].b = lines[0].a;
  EXPECT_THROW((void)Find(lines, gravity_C), std::logic_error);
  EXPECT_THROW((void)Find({}, Vector3d(0.0, 2.0, 0.0)), std::logic_error);
}

}  // namespace
}  // namespace waymark
