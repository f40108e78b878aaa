// The floors of the building differ by what hangs on their walls, and only by
// that: enough for every view to be told from those of all other floors.
#include "drivers/simulator/build_scene.h"
#include "drivers/simulator/renderer.h"
#include "estimation/geometry/pose3.h"
#include "processes/convert/camera_file.h"
#include "processes/convert/world_file.h"

#include <gtest/gtest.h>
#include <opencv2/features2d.hpp>
#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <numbers>
#include <string>
#include <vector>

namespace waymark {
namespace {

constexpr int kNumFloors = 5;
constexpr int kNumHeadings = 4;
// Two descriptors of one thing differ less, two of different things more often
// than not by 300 and more (of a length of 512).
constexpr double kSameFeature = 200.0;
constexpr int kMinOwnFeatures = 30;

// From one place of one floor, all headings.
std::vector<cv::Mat> DescriptorsAt(const Renderer& renderer,
                                   const CameraDescription& camera,
                                   const CameraRays& rays,
                                   const Eigen::Vector2d& p_W) {
  std::vector<cv::Mat> descriptors;
  for (int i = 0; i < kNumHeadings; ++i) {
    const Pose2 X_WR{
        p_W.x(), p_W.y(), 2.0 * std::numbers::pi * i / kNumHeadings};
    const RenderedView view = renderer.Render(
        rays, SpatialPose(X_WR) * camera.X_RC, {}, RenderOptions{});
    cv::Mat gray;
    cv::cvtColor(view.image, gray, cv::COLOR_BGR2GRAY);
    std::vector<cv::KeyPoint> keypoints;
    cv::Mat found;
    cv::SIFT::create()->detectAndCompute(gray, cv::noArray(), keypoints, found);
    descriptors.push_back(found);
  }
  return descriptors;
}

std::vector<Eigen::Vector2d> PlacesOf(const World& world) {
  std::vector<Eigen::Vector2d> places;
  for (const auto* poses : {&world.starts, &world.places}) {
    for (const WorldPose& pose : *poses) {
      places.push_back(pose.X_WR.position());
    }
  }
  return places;
}

// How many of a view's features no view of another floor from that place has.
int OwnFeatures(const cv::Mat& view,
                const std::vector<std::vector<cv::Mat>>& floors,
                std::size_t own) {
  std::vector<bool> is_own(static_cast<std::size_t>(view.rows), true);
  const cv::BFMatcher matcher(cv::NORM_L2);
  for (std::size_t floor = 0; floor < floors.size(); ++floor) {
    if (floor == own) continue;
    for (const cv::Mat& other : floors[floor]) {
      if (view.empty() || other.empty()) continue;
      std::vector<cv::DMatch> matches;
      matcher.match(view, other, matches);
      for (const cv::DMatch& match : matches) {
        if (match.distance < kSameFeature) {
          is_own[static_cast<std::size_t>(match.queryIdx)] = false;
        }
      }
    }
  }
  return static_cast<int>(std::count(is_own.begin(), is_own.end(), true));
}

TEST(BuildingFloors, EveryViewIsToldFromAllOtherFloors) {
  const CameraDescription camera =
      LoadCameraFile(FindCameraFile("perspective"));
  const CameraRays rays({camera.model, camera.size});
  RendererOptions options;
  // Coarse: the same light on all floors is no difference between them.
  options.shader.light_map.cell_size = 1.0;
  // Of each place, floor and heading.
  std::vector<std::vector<std::vector<cv::Mat>>> descriptors;
  for (int floor = 1; floor <= kNumFloors; ++floor) {
    const World world =
        LoadWorldFile(FindWorldFile("building_" + std::to_string(floor)));
    const Renderer renderer(BuildScene(world), options);
    const auto places = PlacesOf(world);
    descriptors.resize(places.size());
    for (std::size_t i = 0; i < places.size(); ++i) {
      descriptors[i].push_back(
          DescriptorsAt(renderer, camera, rays, places[i]));
    }
  }
  int fewest = 1 << 30;
  for (std::size_t i = 0; i < descriptors.size(); ++i) {
    for (std::size_t floor = 0; floor < descriptors[i].size(); ++floor) {
      for (int k = 0; k < kNumHeadings; ++k) {
        const int own =
            OwnFeatures(descriptors[i][floor][static_cast<std::size_t>(k)],
                        descriptors[i],
                        floor);
        fewest = std::min(fewest, own);
        EXPECT_GE(own, kMinOwnFeatures)
            << "place " << i << ", floor " << floor + 1 << ", heading "
            << 90 * k << " deg";
      }
    }
  }
  RecordProperty("fewest", fewest);
}

}  // namespace
}  // namespace waymark
