#include "estimation/lines/manhattan_directions.h"

#include "estimation/base/random.h"
#include "estimation/geometry/angle.h"
#include "tests/support/real_data.h"

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <vector>

namespace waymark {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

double AxisAngle(const Vector3d& a, const Vector3d& b) {
  return std::atan2(a.cross(b).norm(), std::abs(a.dot(b)));
}

// The angles of the one to one assignment with the least sum.
std::array<double, 3> Angles(const Matrix3d& truth, const Matrix3d& found) {
  std::array<int, 3> order{0, 1, 2};
  std::array<double, 3> best{10.0, 10.0, 10.0};
  do {
    std::array<double, 3> angles{};
    for (std::size_t k = 0; k < 3; ++k) {
      angles[k] =
          AxisAngle(truth.col(static_cast<int>(k)), found.col(order[k]));
    }
    if (angles[0] + angles[1] + angles[2] < best[0] + best[1] + best[2]) {
      best = angles;
    }
  } while (std::next_permutation(order.begin(), order.end()));
  return best;
}

void AddEdges(const PinholeView& view,
              const Vector3d& n_C,
              int num,
              Random* random,
              std::vector<LineSegment>* lines) {
  const auto pixel = [&](const Vector3d& p) {
    return Vector2d(view.fx * p.x() / p.z() + view.cx,
                    view.fy * p.y() / p.z() + view.cy);
  };
  while (num > 0) {
    const Vector3d middle(random->Uniform(-3.0, 3.0),
                          random->Uniform(-2.0, 2.0),
                          random->Uniform(3.0, 6.0));
    LineSegment line;
    line.a = pixel(middle - 0.8 * n_C);
    line.b = pixel(middle + 0.8 * n_C);
    if ((line.b - line.a).norm() < 30.0) continue;
    lines->push_back(line);
    --num;
  }
}

TEST(ManhattanDirections, ExactLinesGiveTheRotationNearly) {
  const PinholeView view{400.0, 420.0, 318.0, 243.0};
  Random random(SeedFor(1, "ManhattanDirections.Exact"));
  for (int yaw = -40; yaw <= 40; yaw += 16) {
    for (int tilt = -30; tilt <= 30; tilt += 15) {
      SCOPED_TRACE(std::to_string(yaw) + ' ' + std::to_string(tilt));
      const Matrix3d R_CM =
          (Eigen::AngleAxisd(RadiansFromDegrees(tilt), Vector3d::UnitX()) *
           Eigen::AngleAxisd(RadiansFromDegrees(yaw), Vector3d::UnitY()))
              .toRotationMatrix();
      std::vector<LineSegment> lines;
      for (int k = 0; k < 3; ++k) {
        AddEdges(view, R_CM.col(k), 8, &random, &lines);
      }
      const auto found = FindManhattanDirections(lines, view, {});
      ASSERT_TRUE(found.has_value());
      // Lines that chance lays near another axis count there too, with the
      // defaults' 0.006 rad: a bias of up to 0.0013 here.
      for (const double angle : Angles(R_CM, found->R_CM)) {
        EXPECT_LT(angle, 3e-3);
      }
      EXPECT_NEAR(found->R_CM.determinant(), 1.0, 1e-9);
    }
  }
}

TEST(ManhattanDirections, OneDirectionIsNoAnswer) {
  const PinholeView view{400.0, 420.0, 318.0, 243.0};
  Random random(SeedFor(2, "ManhattanDirections.One"));
  std::vector<LineSegment> lines;
  EXPECT_FALSE(FindManhattanDirections(lines, view, {}).has_value());
  AddEdges(view, Vector3d::UnitY(), 1, &random, &lines);
  EXPECT_FALSE(FindManhattanDirections(lines, view, {}).has_value());
  AddEdges(view, Vector3d::UnitY(), 12, &random, &lines);
  EXPECT_FALSE(FindManhattanDirections(lines, view, {}).has_value());
}

std::vector<LineSegment> ReadSegments(const std::string& path) {
  std::vector<LineSegment> lines;
  std::ifstream in(path);
  std::string row;
  std::getline(in, row);
  while (std::getline(in, row)) {
    std::replace(row.begin(), row.end(), ',', ' ');
    LineSegment line;
    std::istringstream(row) >> line.a.x() >> line.a.y() >> line.b.x() >>
        line.b.y();
    // Ends of half a pixel's error each.
    line.sigma_px = 0.35;
    line.sigma_rad = 0.7 / std::max((line.b - line.a).norm(), 1.0);
    if (line.a != line.b) lines.push_back(line);
  }
  return lines;
}

TEST(ManhattanDirections, OfPhotographs) {
  const std::string folder = RealDataFolder("york_urban_vp");
  if (folder.empty()) GTEST_SKIP() << "no real recordings";
  std::map<std::string, Matrix3d> truths;
  std::ifstream in(folder + "/vp_groundtruth.csv");
  for (std::string row; std::getline(in, row);) {
    if (row.empty() || row[0] == '#') continue;
    std::replace(row.begin(), row.end(), ',', ' ');
    std::istringstream fields(row);
    std::string image;
    std::string name;
    int index = 0;
    Vector3d n;
    if (!(fields >> image >> name >> index >> n.x() >> n.y() >> n.z()))
      continue;
    // Labels have y up.
    n.y() = -n.y();
    if (index < 3) truths[image.substr(0, 3)].col(index) = n.normalized();
  }
  std::vector<double> all;
  for (const auto& [image, truth] : truths) {
    const auto lines = ReadSegments(folder + "/segments/" + image + ".csv");
    const auto found = FindManhattanDirections(
        lines, {674.917, 674.917, 307.5513, 251.4542}, {});
    ASSERT_TRUE(found.has_value()) << image;
    for (const double angle : Angles(truth, found->R_CM)) {
      all.push_back(DegreesFromRadians(angle));
    }
  }
  std::sort(all.begin(), all.end());
  const auto auc = [&](double limit) {
    double sum = 0.0;
    for (const double e : all) sum += std::max(0.0, 1.0 - e / limit);
    return sum / static_cast<double>(all.size());
  };
  RecordProperty("images", static_cast<int>(truths.size()));
  const std::string text =
      std::to_string(auc(3.0)) + ' ' + std::to_string(auc(5.0)) + ' ' +
      std::to_string(auc(10.0)) + ' ' + std::to_string(all[all.size() / 2]);
  RecordProperty("auc_3_5_10_median", text);
  // Measured 0.646, 0.760, 0.866; the labels' own rotation has 0.760, 0.856,
  // 0.928.
  EXPECT_GT(auc(3.0), 0.62) << text;
  EXPECT_GT(auc(5.0), 0.74) << text;
  EXPECT_GT(auc(10.0), 0.84) << text;
}

}  // namespace
}  // namespace waymark
