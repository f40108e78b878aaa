#include "processes/pose_filter/parameter_file.h"

#include "estimation/base/input_error.h"
#include "processes/support/channels.h"
#include "tests/processes/pose_filter/pose_filter_world.h"
#include "tests/support/temporary_directory.h"

#include <waymark/pose_t.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

namespace waymark {
namespace {

using testing::AllOf;
using testing::HasSubstr;

class ParameterFileTest : public testing::Test {
 protected:
  [[nodiscard]] std::string Path() const { return folder_ / "wheels.yaml"; }
  void Write(const std::string& text) const { std::ofstream(Path()) << text; }
  [[nodiscard]] std::string Read() const {
    std::ifstream file(Path());
    return {std::istreambuf_iterator<char>(file), {}};
  }
  static std::string ErrorOf(const PoseFilterConfig& config) {
    try {
      LocalBus bus;
      const PoseFilterProcess process(config, bus.AddProcess("pose_filter"));
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  }
  TemporaryDirectory folder_;
};

TEST_F(ParameterFileTest, LearnedParametersAreReloaded) {
  PoseFilterConfig config = Config();
  config.parameters_file = Path();
  // Wheels 2 % off.
  config.nominal = {1.02e-4, 1e-4, 0.27};
  const OdometryScene scene = Scene(60);
  World first(config);
  first.Publish(scene);
  first.Run();
  const auto learned =
      first.Messages<odometry_parameters_t>(kOdometryParameters).back();
  const std::string saved = Read();
  EXPECT_THAT(saved, HasSubstr("k_right"));
  EXPECT_EQ(
      std::distance(std::filesystem::directory_iterator(folder_ / ""), {}), 1);

  World second(config);
  second.Publish(scene);
  second.Run();
  const auto started =
      second.Messages<odometry_parameters_t>(kOdometryParameters).front();
  EXPECT_NEAR(started.k_right, learned.k_right, 1e-8);
  EXPECT_LT(std::abs(started.k_right - 1e-4), 0.3e-6);
  // Dead reckoning stays nominal.
  EXPECT_EQ(Bytes(first, kOdometry), Bytes(second, kOdometry));
}

TEST_F(ParameterFileTest, CorruptFileIsOneClearLine) {
  PoseFilterConfig config = Config();
  config.parameters_file = Path();
  const auto expect = [&](const std::string& text, const char* part) {
    Write(text);
    const std::string error = ErrorOf(config);
    EXPECT_THAT(error, AllOf(HasSubstr(Path()), HasSubstr(part))) << text;
    EXPECT_EQ(error.find('\n'), std::string::npos);
  };
  expect("", "");
  expect("k_right: [", "");
  expect("k_right: -3\n", "k_right");
  expect("k_rihgt: 3\n", "k_rihgt");
  const std::string good =
      "utime: 5\nk_right: 1e-4\nk_left: 1e-4\nwheel_base: 0.3\n"
      "num_measurements: 3\ncovariance: ";
  Write(good + "[1e-12, 0, 0, 0, 1e-12, 0, 0, 0, 1e-6]\n");
  EXPECT_EQ(ErrorOf(config), "");
  expect(good + "[1e-12, 0, 0]\n", "covariance");
  expect(good + "[-1, 0, 0, 0, 1e-12, 0, 0, 0, 1e-6]\n", "variance -1");
  expect(good + "[1, 2, 0, 0, 1, 0, 0, 0, 1]\n", "symmetric");
  // No file is no error: the first run.
  std::filesystem::remove(Path());
  EXPECT_EQ(ErrorOf(config), "");
}

TEST_F(ParameterFileTest, MissingFolderIsRefusedAtTheStart) {
  PoseFilterConfig config = Config();
  config.parameters_file = folder_ / "absent/wheels.yaml";
  EXPECT_THAT(ErrorOf(config),
              AllOf(HasSubstr("absent/wheels.yaml: cannot be written: "),
                    HasSubstr("No such file or directory")));
}

TEST_F(ParameterFileTest, PlaceThatVanishesIsReportedAndDrivingGoesOn) {
  PoseFilterConfig config = Config();
  config.parameters_file = folder_ / "absent/wheels.yaml";
  std::filesystem::create_directory(folder_ / "absent");
  const OdometryScene scene = Scene(60);
  World world(config);
  std::filesystem::remove(folder_ / "absent");
  world.Publish(scene);
  world.bus.Run();
  EXPECT_THAT(StatusOf(world.bus).fault, HasSubstr("absent/wheels.yaml"));
  EXPECT_TRUE(world.Messages<pose_t>(kPose).back().is_known);
  EXPECT_THROW(world.process.Finish(), InputError);
}

// A device that is always full: the old file survives.
TEST_F(ParameterFileTest, FullDiskLeavesTheOldFile) {
  std::filesystem::create_symlink("/dev/full", Path() + ".new");
  Write("old");
  OdometryParameters parameters;
  parameters.time = TimeFromMicroseconds(4);
  parameters.parameters = {1e-4, 1e-4, 0.3};
  EXPECT_THROW(SaveParameterFile(Path(), parameters), InputError);
  EXPECT_EQ(Read(), "old");
}

}  // namespace
}  // namespace waymark
