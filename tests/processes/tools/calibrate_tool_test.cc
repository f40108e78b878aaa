#include "processes/tools/calibrate/calibrate_tool.h"

#include "estimation/camera/camera_parameters.h"
#include "estimation/geometry/angle.h"
#include "processes/convert/camera_file.h"
#include "tests/support/board_image.h"
#include "tests/support/real_data.h"
#include "tests/support/temporary_directory.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <utility>
#include <vector>

namespace waymark {
namespace {

using testing::HasSubstr;

const ChessBoard kBoard{.columns = 7, .rows = 5, .square = 0.04};
const ImageSize kSize{480, 360};

class CalibrateTool : public testing::Test {
 protected:
  int Run(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "waymark-calibrate");
    std::vector<char*> argv;
    for (std::string& argument : arguments) argv.push_back(argument.data());
    testing::internal::CaptureStdout();
    testing::internal::CaptureStderr();
    const int code =
        RunCalibrateTool(static_cast<int>(argv.size()), argv.data());
    out_ = testing::internal::GetCapturedStdout();
    error_ = testing::internal::GetCapturedStderr();
    return code;
  }

  // Boards ahead and to all sides, tilted.
  std::vector<std::string> DrawBoards(const CameraModel& camera) {
    std::vector<std::string> paths;
    for (int i = 0; i < 6; ++i) {
      Eigen::Isometry3d X_CB = Eigen::Isometry3d::Identity();
      const double azimuth = i * kPi / 3;
      X_CB.linear() =
          Eigen::AngleAxisd(
              0.5,
              Eigen::Vector3d(std::cos(azimuth), std::sin(azimuth), 0.2 * i)
                  .normalized())
              .toRotationMatrix();
      X_CB.translation() =
          Eigen::Vector3d(
              0.1 * std::cos(azimuth), 0.07 * std::sin(azimuth), 0.42) -
          X_CB.linear() * Eigen::Vector3d(0.12, 0.08, 0.0);
      paths.push_back(directory_ / ("board" + std::to_string(i) + ".png"));
      cv::imwrite(paths.back(), DrawBoard(camera, kSize, kBoard, X_CB));
    }
    return paths;
  }

  TemporaryDirectory directory_;
  std::string out_;
  std::string error_;
};

TEST_F(CalibrateTool, FindsTheCameraThatDrewTheBoards) {
  const FisheyeCamera camera({240.0, 241.0, 238.0, 181.0}, {0.02, -0.005});
  std::vector<std::string> arguments = DrawBoards(camera);
  const std::string blank = directory_ / "blank.png";
  cv::imwrite(blank, cv::Mat(kSize.height, kSize.width, CV_8UC1, 127.0));
  arguments.push_back(blank);
  const std::string out = directory_ / "camera.yaml";
  const std::string json = directory_ / "camera.json";
  const std::string pictures = directory_ / "pictures";
  for (const char* flag : {"--model",
                           "fisheye",
                           "--board",
                           "7x5",
                           "--square",
                           "0.04",
                           "--distortion",
                           "2"}) {
    arguments.emplace_back(flag);
  }
  arguments.insert(arguments.end(), {"--out", out, "--json", json});
  arguments.insert(arguments.end(), {"--pictures", pictures});
  ASSERT_EQ(Run(arguments), 0) << error_;
  EXPECT_THAT(out_, HasSubstr("blank.png: no whole board of 7 x 5 corners"));
  EXPECT_THAT(out_, HasSubstr("fisheye camera, 480 x 360 px"));
  const CameraDescription found = LoadCameraFile(out);
  EXPECT_EQ(found.size, kSize);
  // Corners are found to some hundredths of a pixel.
  EXPECT_LT((ParametersOf(found.model) - ParametersOf(CameraModel(camera)))
                .head<4>()
                .cwiseAbs()
                .maxCoeff(),
            0.5);
  std::ifstream file(json);
  const auto results = nlohmann::json::parse(file);
  EXPECT_LT(results["rms_px"], 0.1);
  EXPECT_EQ(results["images"].size(), 6u);
  EXPECT_EQ(results["parameters"]["k3"]["sigma"], 0.0);
  EXPECT_TRUE(std::filesystem::exists(pictures + "/board0_residuals.png"));
  // Nothing is written over without being asked to.
  EXPECT_EQ(Run(arguments), 2);
  EXPECT_THAT(error_, HasSubstr("camera.yaml: exists already"));
  arguments.emplace_back("--force");
  EXPECT_EQ(Run(arguments), 0) << error_;
}

TEST_F(CalibrateTool, BadInputIsOneLine) {
  const std::string text = directory_ / "text.png";
  std::ofstream(text) << "no image";
  const std::string blank = directory_ / "blank.png";
  cv::imwrite(blank, cv::Mat(20, 30, CV_8UC1, 127.0));
  const std::string other = directory_ / "other.png";
  cv::imwrite(other, cv::Mat(30, 20, CV_8UC1, 127.0));
  const auto error = [this](std::vector<std::string> arguments) {
    EXPECT_EQ(Run(std::move(arguments)), 2);
    EXPECT_EQ(std::count(error_.begin(), error_.end(), '\n'), 1) << error_;
    return error_;
  };
  EXPECT_THAT(error({text, "--square", "0.04"}),
              HasSubstr("text.png: is no PNG"));
  EXPECT_THAT(error({"none.png", "--square", "0.04"}),
              HasSubstr("none.png: cannot be opened"));
  EXPECT_THAT(error({blank, other, "--square", "0.04"}),
              HasSubstr("is 20 x 30 px, the first image 30 x 20"));
  EXPECT_THAT(error({blank, "--square", "0.04"}),
              HasSubstr("fewer than two views"));
  EXPECT_THAT(error({blank, "--square", "nan"}), HasSubstr("--square"));
  EXPECT_THAT(error({blank, "--square", "0.04", "--board", "8"}),
              HasSubstr("--board 8"));
  EXPECT_THAT(error({blank, "--square", "0.04", "--board", "2x6"}),
              HasSubstr("3 to 100"));
  EXPECT_THAT(error({blank, "--square", "0.04", "--model", "wide"}),
              HasSubstr("perspective, fisheye, sphere"));
  EXPECT_THAT(error({blank, "--square", "0.04", "--xi", "1"}),
              HasSubstr("xi goes with a sphere camera"));
}

// A parabolic mirror by others; the board seen in six images.
TEST_F(CalibrateTool, ExplainsARealMirrorCamera) {
  const std::string folder = RealDataFolder("mei_catadioptric_calib");
  if (folder.empty()) GTEST_SKIP() << "no real recordings";
  std::vector<std::string> arguments;
  for (int i = 1; i <= 6; ++i) {
    arguments.push_back(folder + "/img_para_00" + std::to_string(i) + ".png");
  }
  const std::string json = directory_ / "camera.json";
  for (const char* flag : {"--model",
                           "sphere",
                           "--board",
                           "8x6",
                           "--square",
                           "0.042",
                           "--mirrored",
                           "--xi",
                           "1",
                           "--distortion",
                           "2"}) {
    arguments.emplace_back(flag);
  }
  arguments.insert(arguments.end(), {"--json", json});
  ASSERT_EQ(Run(arguments), 0) << error_;
  std::ifstream file(json);
  const auto results = nlohmann::json::parse(file);
  EXPECT_EQ(results["images"].size(), 6u);
  // A corner of these images, overexposed, to 0.3 px in x and y.
  EXPECT_LT(results["rms_px"], 0.45);
}

}  // namespace
}  // namespace waymark
