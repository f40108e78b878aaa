#include "processes/tools/calibrate/calibrate_tool.h"

#include "drivers/video/image_file.h"
#include "estimation/base/input_error.h"
#include "estimation/camera/board_detector.h"
#include "estimation/camera/calibrate_camera.h"
#include "estimation/camera/pan_tilt_mount.h"
#include "processes/convert/camera_file.h"
#include "processes/support/output_file.h"
#include "processes/support/progress.h"
#include "processes/support/run_tool.h"
#include "processes/tools/calibrate/calibrate_report.h"

#include <CLI/CLI.hpp>
#include <opencv2/imgcodecs.hpp>

#include <cstdio>
#include <filesystem>
#include <set>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace waymark {
namespace {

struct Request {
  std::vector<std::string> images;
  std::string model = "perspective";
  std::string board = "8x6";
  double square = 0.0;
  bool is_mirrored = false;
  double xi = 0.0;
  bool has_xi = false;
  int num_distortion = -1;  // The model's default.
  std::string out;
  std::string json;
  std::string pictures;
  bool force = false;

  [[nodiscard]] IfExists if_exists() const {
    return force ? IfExists::kReplace : IfExists::kFail;
  }
};

ChessBoard BoardOf(const Request& request) {
  ChessBoard board;
  char rest = 0;
  if (std::sscanf(request.board.c_str(),
                  "%dx%d%c",
                  &board.columns,
                  &board.rows,
                  &rest) != 2) {
    throw InputError("--board " + request.board +
                     ": must be COLUMNSxROWS of inner corners, as 8x6");
  }
  board.square = request.square;
  try {
    board.Check();
  } catch (const std::invalid_argument& error) {
    throw InputError("--board " + request.board + ": " + error.what());
  }
  return board;
}

CalibrationOptions OptionsOf(const Request& request) {
  CalibrationOptions options;
  try {
    options.kind = CameraKindFromName(request.model);
  } catch (const std::invalid_argument& error) {
    throw InputError("--model " + request.model + ": " + error.what());
  }
  options.is_mirrored = request.is_mirrored;
  if (request.has_xi) options.xi = request.xi;
  if (request.num_distortion >= 0) {
    options.num_distortion = request.num_distortion;
  }
  options.size = {1, 1};  // Known with the first image.
  try {
    options.Check();
  } catch (const std::invalid_argument& error) {
    throw InputError(error.what());
  }
  return options;
}

std::vector<BoardImage> FindBoards(const Request& request,
                                   const ChessBoard& board,
                                   ImageSize* size) {
  std::vector<BoardImage> found;
  Progress progress("looking for boards",
                    static_cast<std::int64_t>(request.images.size()));
  for (std::size_t i = 0; i < request.images.size(); ++i) {
    const std::string& path = request.images[i];
    progress.Show(static_cast<std::int64_t>(i));
    const cv::Mat image = LoadImageFile(path, ImageFileColor::kGray);
    const ImageSize now{image.cols, image.rows};
    if (i == 0) *size = now;
    if (!(now == *size)) {
      throw InputError(path + ": is " + std::to_string(now.width) + " x " +
                       std::to_string(now.height) + " px, the first image " +
                       std::to_string(size->width) + " x " +
                       std::to_string(size->height));
    }
    if (auto corners = FindBoardCorners(image, board)) {
      found.push_back({path, {std::move(*corners), board.Corners()}});
    } else {
      progress.Clear();
      std::printf("%s: no whole board of %d x %d corners, left out\n",
                  path.c_str(),
                  board.columns,
                  board.rows);
    }
  }
  return found;
}

void WriteText(const std::string& path,
               const std::string& text,
               IfExists if_exists) {
  if (path.empty()) return;
  OutputFile file(path, if_exists);
  file.Write(text);
  file.Close();
}

std::string PicturePath(const Request& request, const std::string& image) {
  const std::filesystem::path path(image);
  return (std::filesystem::path(request.pictures) /
          (path.stem().string() + "_residuals.png"))
      .string();
}

void WritePictures(const Request& request,
                   const std::vector<BoardImage>& images,
                   const CameraCalibration& calibration) {
  if (request.pictures.empty()) return;
  for (std::size_t i = 0; i < images.size(); ++i) {
    const std::string path = PicturePath(request, images[i].path);
    if (!cv::imwrite(
            path,
            DrawResiduals(LoadImageFile(images[i].path, ImageFileColor::kGray),
                          images[i].view,
                          calibration.views[i],
                          calibration.camera))) {
      throw InputError(path + ": cannot be written");
    }
  }
  std::printf("pictures of the residuals, 50 times as long, in %s\n",
              request.pictures.c_str());
}

void CheckOutputs(const Request& request) {
  for (const std::string& path : {request.out, request.json}) {
    if (!path.empty()) CheckOutput(path, request.if_exists(), request.images);
  }
  if (request.pictures.empty()) return;
  std::error_code error;
  std::filesystem::create_directories(request.pictures, error);
  if (!std::filesystem::is_directory(request.pictures)) {
    throw InputError(request.pictures + ": cannot be made");
  }
  std::set<std::string> paths;
  for (const std::string& image : request.images) {
    const std::string path = PicturePath(request, image);
    if (!paths.insert(path).second) {
      throw InputError(image +
                       ": another image has the same name: there is "
                       "one " +
                       path + " for both");
    }
    CheckOutput(path, request.if_exists(), request.images);
  }
}

void Run(const Request& request) {
  const ChessBoard board = BoardOf(request);
  CalibrationOptions options = OptionsOf(request);
  CheckOutputs(request);
  const std::vector<BoardImage> images =
      FindBoards(request, board, &options.size);
  std::vector<BoardView> views;
  for (const BoardImage& image : images) views.push_back(image.view);
  const CalibrationReport report = CalibrateCamera(views, options);
  if (!report.result) throw InputError("no calibration: " + report.reason);
  std::fputs(CalibrationTable(*report.result, images, options).c_str(), stdout);
  CameraDescription camera;
  camera.model = report.result->camera;
  camera.size = options.size;
  camera.X_RC.linear() = ForwardCameraRotation();
  WriteText(request.out, YamlOfCamera(camera), request.if_exists());
  WriteText(request.json,
            CalibrationJson(*report.result, images, options),
            request.if_exists());
  WritePictures(request, images, *report.result);
}

}  // namespace

int RunCalibrateTool(int argc, char** argv) {
  Request request;
  return RunTool(
      argc,
      argv,
      "waymark-calibrate",
      "A camera's model from images of a chessboard: hold it tilted, near and "
      "far, over the whole image, ten times or more.",
      [&](CLI::App* app, int* /*exit_code*/) {
        app->add_option("IMAGE", request.images, "Images of one size")
            ->required();
        app->add_option("--model",
                        request.model,
                        "perspective, fisheye (Kannala-Brandt) or sphere "
                        "(unified model: mirrors, very wide lenses)")
            ->capture_default_str();
        app->add_option("--board", request.board, "Inner corners, as 8x6")
            ->capture_default_str();
        RequireRange(
            app->add_option(
                "--square", request.square, "Side of the board's squares, m"),
            1e-4,
            10.0)
            ->required();
        app->add_flag("--mirrored",
                      request.is_mirrored,
                      "The image is mirrored: one lens that looks into one "
                      "mirror");
        auto* xi =
            RequireRange(app->add_option("--xi",
                                         request.xi,
                                         "Of the sphere model, where it is "
                                         "known (1: parabolic mirror)"),
                         0.0,
                         10.0);
        app->add_option("--distortion",
                        request.num_distortion,
                        "How many coefficients of the lens to estimate: 0 to 5 "
                        "(fisheye 4); default 4")
            ->check(CLI::Range(0, 5));
        app->add_option("--out", request.out, "Camera file (YAML)");
        app->add_option("--json", request.json, "Results as JSON");
        app->add_option("--pictures",
                        request.pictures,
                        "Folder for pictures of the residuals");
        app->add_flag(
            "-f,--force", request.force, "Replace outputs that exist");
        app->callback([&request, xi] {
          request.has_xi = xi->count() > 0;
          Run(request);
        });
      });
}

}  // namespace waymark
