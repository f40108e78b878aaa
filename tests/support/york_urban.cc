#include "tests/support/york_urban.h"

#include "tests/support/real_data.h"

#include <Eigen/Geometry>
#include <Eigen/SVD>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>
#include <sstream>
#include <stdexcept>

namespace waymark {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

double AxisAngle(const Vector3d& a, const Vector3d& b) {
  return std::atan2(a.cross(b).norm(), std::abs(a.dot(b)));
}

std::ifstream Open(const std::string& path) {
  std::ifstream in(path);
  if (!in) throw std::runtime_error(path + ": cannot be read");
  return in;
}

std::map<std::string, Matrix3d> ReadAxes(const std::string& path) {
  std::map<std::string, Matrix3d> axes;
  std::ifstream in = Open(path);
  for (std::string row; std::getline(in, row);) {
    if (row.empty() || row[0] == '#') continue;
    std::replace(row.begin(), row.end(), ',', ' ');
    std::istringstream fields(row);
    std::string image;
    std::string original;
    int index = 0;
    Vector3d n;
    if (!(fields >> image >> original >> index >> n.x() >> n.y() >> n.z())) {
      throw std::runtime_error(path + ": " + row);
    }
    // Labels have y up. From 3 on they are other directions.
    n.y() = -n.y();
    if (index < 3) axes[image.substr(0, 3)].col(index) = n.normalized();
  }
  return axes;
}

std::vector<LineSegment> ReadSegments(const std::string& path) {
  std::vector<LineSegment> segments;
  std::ifstream in = Open(path);
  std::string row;
  std::getline(in, row);  // Names of the columns.
  while (std::getline(in, row)) {
    std::replace(row.begin(), row.end(), ',', ' ');
    Vector2d a;
    Vector2d b;
    if (!(std::istringstream(row) >> a.x() >> a.y() >> b.x() >> b.y())) {
      throw std::runtime_error(path + ": " + row);
    }
    if (a != b) segments.push_back(SegmentBetween(a, b));
  }
  return segments;
}

}  // namespace

std::vector<YorkPhotograph> ReadYorkPhotographs() {
  std::vector<YorkPhotograph> photographs;
  const std::string folder = RealDataFolder("york_urban_vp");
  if (folder.empty()) return photographs;
  for (const auto& [name, axes] : ReadAxes(folder + "/vp_groundtruth.csv")) {
    photographs.push_back(
        {name, axes, ReadSegments(folder + "/segments/" + name + ".csv")});
  }
  return photographs;
}

PinholeView YorkView() {
  return {674.917, 674.917, 307.5513, 251.4542};
}

LineSegment SegmentBetween(const Vector2d& a, const Vector2d& b) {
  constexpr double kEndPx = 0.3;
  LineSegment segment;
  segment.a = a;
  segment.b = b;
  segment.sigma_px = kEndPx / std::sqrt(2.0);
  segment.sigma_rad = kEndPx * std::sqrt(2.0) / std::max((b - a).norm(), 1.0);
  return segment;
}

std::array<double, 3> AxisAngles(const Matrix3d& truth, const Matrix3d& found) {
  std::array<int, 3> order{0, 1, 2};
  std::array<double, 3> best{10.0, 10.0, 10.0};  // More than three angles.
  do {
    std::array<double, 3> angles{};
    for (int k = 0; k < 3; ++k) {
      const auto at = static_cast<std::size_t>(k);
      angles[at] = AxisAngle(truth.col(k), found.col(order[at]));
    }
    if (angles[0] + angles[1] + angles[2] < best[0] + best[1] + best[2]) {
      best = angles;
    }
  } while (std::next_permutation(order.begin(), order.end()));
  return best;
}

Matrix3d NearestOrthogonal(const Matrix3d& axes) {
  const Eigen::JacobiSVD<Matrix3d> svd(
      axes, Eigen::ComputeFullU | Eigen::ComputeFullV);
  return svd.matrixU() * svd.matrixV().transpose();
}

DirectionScore ScoreAngles(std::vector<double> angles_deg) {
  DirectionScore score;
  if (angles_deg.empty()) return score;
  std::sort(angles_deg.begin(), angles_deg.end());
  const auto auc = [&](double limit) {
    double sum = 0.0;
    for (const double e : angles_deg) sum += std::max(0.0, 1.0 - e / limit);
    return sum / static_cast<double>(angles_deg.size());
  };
  score.auc_3 = auc(3.0);
  score.auc_5 = auc(5.0);
  score.auc_10 = auc(10.0);
  score.median_deg = angles_deg[angles_deg.size() / 2];
  return score;
}

}  // namespace waymark
