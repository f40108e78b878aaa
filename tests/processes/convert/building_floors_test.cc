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
#include <limits>
#include <numbers>
#include <string>
#include <vector>

namespace waymark {
namespace {

constexpr int kNumFloors = 5;
constexpr int kNumHeadings = 4;
// Two descriptors of one thing differ less, two of different things more often
// than not by 300 and more (of a length of 512).
constexpr float kSameFeature = 200.0F;
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

// What a view shows, and where it was taken.
struct View {
  std::string name;
  cv::Mat descriptors;
};

// Square of the least distance of each row of `some` from any of `all`.
std::vector<float> LeastDistances2(const cv::Mat& some, const cv::Mat& all) {
  cv::Mat products;
  cv::gemm(some, all, -2.0, cv::noArray(), 0.0, products, cv::GEMM_2_T);
  cv::Mat lengths2;
  cv::reduce(all.mul(all), lengths2, 1, cv::REDUCE_SUM);
  std::vector<float> least;
  for (int i = 0; i < some.rows; ++i) {
    const float* row = products.ptr<float>(i);
    float best = std::numeric_limits<float>::infinity();
    for (int k = 0; k < all.rows; ++k) {
      best = std::min(best, row[k] + lengths2.at<float>(k));
    }
    least.push_back(best + static_cast<float>(some.row(i).dot(some.row(i))));
  }
  return least;
}

// Features of a view that no view of any other floor has, wherever from; counts
// no further than kMinOwnFeatures.
int OwnFeatures(const cv::Mat& view,
                const std::vector<cv::Mat>& floors,
                std::size_t own) {
  constexpr int kAtOnce = 64;
  int count = 0;
  for (int begin = 0; begin < view.rows && count < kMinOwnFeatures;
       begin += kAtOnce) {
    const int end = std::min(view.rows, begin + kAtOnce);
    cv::Mat left = view.rowRange(begin, end);
    for (std::size_t floor = 0; floor < floors.size() && !left.empty();
         ++floor) {
      if (floor == own) continue;
      const std::vector<float> least = LeastDistances2(left, floors[floor]);
      cv::Mat kept;
      for (int i = 0; i < left.rows; ++i) {
        if (least[static_cast<std::size_t>(i)] >= kSameFeature * kSameFeature) {
          kept.push_back(left.row(i));
        }
      }
      left = kept;
    }
    count += left.rows;
  }
  return count;
}

TEST(BuildingFloors, EveryViewIsToldFromAllViewsOfOtherFloors) {
  const CameraDescription camera =
      LoadCameraFile(FindCameraFile("perspective"));
  const CameraRays rays({camera.model, camera.size});
  RendererOptions options;
  // Coarse: the same light on all floors is no difference between them.
  options.shader.light_map.cell_size = 1.0;
  std::vector<std::vector<View>> views;  // Of each floor.
  std::vector<cv::Mat> floors;           // All descriptors of each.
  for (int floor = 1; floor <= kNumFloors; ++floor) {
    const World world =
        LoadWorldFile(FindWorldFile("building_" + std::to_string(floor)));
    const Renderer renderer(BuildScene(world), options);
    views.emplace_back();
    floors.emplace_back();
    const std::vector<Eigen::Vector2d> places = PlacesOf(world);
    for (std::size_t i = 0; i < places.size(); ++i) {
      const auto found = DescriptorsAt(renderer, camera, rays, places[i]);
      for (int k = 0; k < kNumHeadings; ++k) {
        views.back().push_back({"floor " + std::to_string(floor) + ", place " +
                                    std::to_string(i) + ", heading " +
                                    std::to_string(90 * k) + " deg",
                                found[static_cast<std::size_t>(k)]});
        ASSERT_FALSE(views.back().back().descriptors.empty());
        floors.back().push_back(views.back().back().descriptors);
      }
    }
  }
  for (std::size_t floor = 0; floor < views.size(); ++floor) {
    for (const View& view : views[floor]) {
      EXPECT_GE(OwnFeatures(view.descriptors, floors, floor), kMinOwnFeatures)
          << view.name;
    }
  }
}

}  // namespace
}  // namespace waymark
