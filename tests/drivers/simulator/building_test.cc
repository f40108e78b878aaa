// The floors of the building look alike but for what hangs on their walls and
// doors: of that, enough is in every view to tell the floor by.
#include "drivers/simulator/build_scene.h"
#include "drivers/simulator/renderer.h"
#include "processes/convert/world_file.h"

#include <gtest/gtest.h>
#include <opencv2/core.hpp>
#include <opencv2/features2d.hpp>
#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

namespace waymark {
namespace {

constexpr int kNumFloors = 5;
constexpr int kNeeded = 30;
constexpr double kStep = 2.5;          // Between poses on a route, m.
constexpr double kCameraHeight = 1.0;  // m.
// Descriptors of SIFT are 512 long. Those of one corner seen twice differ by
// less than 100, of two corners mostly by more than 250.
constexpr float kSame = 200.0f;
constexpr float kRatio = 0.8f;

struct Features {
  std::vector<cv::KeyPoint> points;
  cv::Mat1f descriptors;
};

Features FeaturesOf(const cv::Mat3b& image) {
  cv::Mat1b grey;
  cv::cvtColor(image, grey, cv::COLOR_BGR2GRAY);
  Features features;
  cv::SIFT::create(1000)->detectAndCompute(
      grey, cv::noArray(), features.points, features.descriptors);
  return features;
}

// Marks the features of `a` that `b` has too: those nearest to each other and
// clearly nearer than the next, and all that are as near as one corner seen
// twice, however often it is there.
void MarkFound(const Features& a, const Features& b, std::vector<char>* found) {
  if (a.descriptors.empty() || b.descriptors.empty()) return;
  const cv::BFMatcher matcher(cv::NORM_L2);
  std::vector<std::vector<cv::DMatch>> there;
  std::vector<cv::DMatch> back;
  matcher.knnMatch(a.descriptors, b.descriptors, there, 2);
  matcher.match(b.descriptors, a.descriptors, back);
  for (std::size_t i = 0; i < there.size(); ++i) {
    const cv::DMatch& best = there[i][0];
    const bool is_mutual =
        back[static_cast<std::size_t>(best.trainIdx)].trainIdx ==
        static_cast<int>(i);
    const bool is_clear =
        there[i].size() < 2 || best.distance < kRatio * there[i][1].distance;
    if (best.distance < kSame || (is_mutual && is_clear)) (*found)[i] = 1;
  }
}

// Fewest features, over the floors, that no other floor has in its view.
int FewestOwn(const std::vector<Features>& views) {
  std::ptrdiff_t fewest = std::numeric_limits<std::ptrdiff_t>::max();
  for (std::size_t a = 0; a < views.size(); ++a) {
    std::vector<char> found(views[a].points.size(), 0);
    for (std::size_t b = 0; b < views.size(); ++b) {
      if (b != a) MarkFound(views[a], views[b], &found);
    }
    fewest = std::min(fewest, std::count(found.begin(), found.end(), 0));
  }
  return static_cast<int>(fewest);
}

Eigen::Isometry3d LookFrom(const Eigen::Vector2d& p, double yaw) {
  Eigen::Isometry3d X_WC = Eigen::Isometry3d::Identity();
  X_WC.translation() << p, kCameraHeight;
  const double c = std::cos(yaw);
  const double s = std::sin(yaw);
  X_WC.linear().col(0) << s, -c, 0.0;
  X_WC.linear().col(1) << 0.0, 0.0, -1.0;
  X_WC.linear().col(2) << c, s, 0.0;
  return X_WC;
}

struct Place {
  Eigen::Vector2d p_W;
  double heading = 0.0;
};

std::vector<Place> PlacesOf(const World& world) {
  std::vector<Place> places;
  for (const WorldRoute& route : world.routes) {
    for (std::size_t i = 0; i + 1 < route.points.size(); ++i) {
      const Eigen::Vector2d way = route.points[i + 1] - route.points[i];
      for (double s = 0.0; s < way.norm(); s += kStep) {
        places.push_back({route.points[i] + s * way.normalized(),
                          std::atan2(way.y(), way.x())});
      }
    }
  }
  for (const WorldPose& place : world.places) {
    places.push_back({place.X_WR.position(), place.X_WR.heading});
  }
  return places;
}

TEST(Building, EveryViewTellsTheFloor) {
  const char* source = std::getenv("WAYMARK_SOURCE");
  if (source == nullptr) GTEST_SKIP() << "WAYMARK_SOURCE is not set";
  // Light changes no corner: coarse is enough.
  RendererOptions options;
  options.shader.light_map.cell_size = 1.0;
  options.shader.light.lamp_samples = 1;
  options.shader.light.num_rings = 2;
  RenderOptions quick;
  quick.quality = RenderQuality::kSingle;
  std::vector<Renderer> floors;
  World world;
  for (int floor = 1; floor <= kNumFloors; ++floor) {
    world = LoadWorldFile(std::string(source) +
                          "/drivers/simulator/worlds/building_" +
                          std::to_string(floor) + ".yaml");
    floors.emplace_back(BuildScene(world), options);
  }
  const CameraRays panorama(
      {PanoramaCamera::WholeTurn({1024, 256}, 127.5), {1024, 256}});
  const CameraRays perspective(
      {PerspectiveCamera({390.0, 390.0, 319.5, 239.5}), {640, 480}});
  const std::vector<Place> places = PlacesOf(world);
  ASSERT_GE(places.size(), 10u);
  for (const Place& place : places) {
    // Four ways with the perspective camera, then the panorama.
    for (int turn = 0; turn <= 4; ++turn) {
      const double yaw = place.heading + turn * std::numbers::pi / 2.0;
      std::vector<Features> views;
      for (const Renderer& floor : floors) {
        views.push_back(
            FeaturesOf(floor
                           .Render(turn < 4 ? perspective : panorama,
                                   LookFrom(place.p_W, yaw),
                                   {},
                                   quick)
                           .image));
      }
      EXPECT_GE(FewestOwn(views), kNeeded)
          << (turn < 4 ? "perspective" : "panorama") << " at "
          << place.p_W.transpose() << ", heading " << yaw;
    }
  }
}

}  // namespace
}  // namespace waymark
