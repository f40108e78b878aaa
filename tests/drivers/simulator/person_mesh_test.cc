#include "drivers/simulator/person_mesh.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include <algorithm>
#include <stdexcept>

namespace waymark {
namespace {

using testing::HasSubstr;

Scene OnePerson(const PersonOptions& options) {
  Scene scene;
  EXPECT_EQ(AppendPerson("Ada", options, &scene), 0u);
  return scene;
}

TEST(PersonMesh, FillsTheCylinderThatHoldsIt) {
  for (const PersonPose pose : {PersonPose::kStanding, PersonPose::kMidStep}) {
    for (const double height : {1.2, 1.75, 2.0}) {
      PersonOptions options;
      options.height = height;
      options.radius = 0.3;
      options.pose = pose;
      const Scene scene = OnePerson(options);
      CheckScene(scene);
      float low = 1e9f;
      float high = -1e9f;
      float reach = 0.0f;
      for (const Eigen::Vector3f& p : scene.movers[0].mesh.positions) {
        low = std::min(low, p.z());
        high = std::max(high, p.z());
        reach = std::max(reach, p.head<2>().norm());
      }
      // Rounding of floats.
      EXPECT_NEAR(low, 0.0, 1e-6);
      EXPECT_NEAR(high, height, 1e-6);
      EXPECT_NEAR(reach, 0.3, 1e-6);
      EXPECT_EQ(scene.movers[0].height, height);
      EXPECT_EQ(scene.movers[0].radius, 0.3);
    }
  }
}

TEST(PersonMesh, HasAModestNumberOfTriangles) {
  const Scene scene = OnePerson({});
  EXPECT_GE(scene.movers[0].mesh.triangles.size(), 1000u);
  EXPECT_LE(scene.movers[0].mesh.triangles.size(), 4000u);
  EXPECT_EQ(scene.surfaces.at(0).kind, SurfaceKind::kPerson);
}

// The nose: what is furthest forward at the height of the head is ahead of the
// middle by more than anything is behind it; feet point forward too.
TEST(PersonMesh, LooksAlongX) {
  const Scene scene = OnePerson({});
  float front = 0.0f;
  float back = 0.0f;
  float toes = 0.0f;
  float heels = 0.0f;
  for (const Eigen::Vector3f& p : scene.movers[0].mesh.positions) {
    if (p.z() > 1.56f && p.z() < 1.62f) front = std::max(front, p.x());
    if (p.z() > 1.56f && p.z() < 1.62f) back = std::min(back, p.x());
    if (p.z() < 0.03f) toes = std::max(toes, p.x());
    if (p.z() < 0.03f) heels = std::min(heels, p.x());
  }
  EXPECT_GT(front, -back + 0.02f);
  EXPECT_GT(toes, -heels + 0.02f);
}

TEST(PersonMesh, SeedsGiveOtherPeopleTheSameSeedTheSame) {
  PersonOptions options;
  const Scene once = OnePerson(options);
  const Scene again = OnePerson(options);
  ASSERT_EQ(once.materials.size(), again.materials.size());
  for (std::size_t i = 0; i < once.materials.size(); ++i) {
    EXPECT_EQ(cv::norm(once.materials[i].texture,
                       again.materials[i].texture,
                       cv::NORM_INF),
              0.0);
  }
  EXPECT_EQ(once.movers[0].mesh.positions, again.movers[0].mesh.positions);
  options.seed = 2;
  const Scene other = OnePerson(options);
  EXPECT_NE(once.materials[1].texture(0, 0), other.materials[1].texture(0, 0));
}

TEST(PersonMesh, AppendsToWhatIsThere) {
  Scene scene;
  AppendPerson("Ada", {}, &scene);
  EXPECT_EQ(AppendPerson("Bea", {}, &scene), 1u);
  CheckScene(scene);
  EXPECT_EQ(scene.surfaces.at(scene.movers[1].mesh.triangles[0].surface).name,
            "Bea");
  EXPECT_THAT(
      scene.materials.at(scene.movers[1].mesh.triangles[0].material).name,
      HasSubstr("Bea"));
}

TEST(PersonMesh, RefusesSizesNoPersonHas) {
  Scene scene;
  PersonOptions options;
  options.height = 3.0;
  EXPECT_THROW(AppendPerson("Ada", options, &scene), std::invalid_argument);
  options = {};
  options.radius = 0.0;
  EXPECT_THROW(AppendPerson("Ada", options, &scene), std::invalid_argument);
  EXPECT_TRUE(scene.surfaces.empty());
}

}  // namespace
}  // namespace waymark
