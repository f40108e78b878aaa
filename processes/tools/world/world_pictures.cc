#include "processes/tools/world/world_pictures.h"

#include "estimation/base/input_error.h"

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include <cmath>
#include <cstdint>
#include <filesystem>

namespace waymark {
namespace {

std::string Extension(const std::string& path) {
  return std::filesystem::path(path).extension().string();
}

}  // namespace

void CheckImageOutput(const std::string& path,
                      const std::string& option,
                      bool is_exact,
                      IfExists if_exists) {
  if (path.empty()) return;
  const std::string extension = Extension(path);
  if (extension != ".png" && (is_exact || extension != ".jpg")) {
    throw InputError(option + " " + path + ": must end in .png" +
                     (is_exact ? "" : " or .jpg"));
  }
  CheckOutput(path, if_exists, {});
}

void WriteImage(const std::string& path,
                const cv::Mat& image,
                IfExists if_exists) {
  std::vector<std::uint8_t> bytes;
  const std::vector<int> parameters =
      Extension(path) == ".jpg"
          ? std::vector<int>{cv::IMWRITE_JPEG_QUALITY, 88}
          : std::vector<int>{cv::IMWRITE_PNG_COMPRESSION, 6};
  cv::imencode(Extension(path), image, bytes, parameters);
  OutputFile file(path, if_exists);
  file.Write({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
  file.Close();
}

cv::Mat1w DepthImage(const cv::Mat1f& depth) {
  cv::Mat1w image;
  depth.convertTo(image, CV_16U, 1000.0);
  return image;
}

cv::Mat3b SurfaceImage(const cv::Mat1i& surface) {
  cv::Mat3b image(surface.size());
  for (int y = 0; y < surface.rows; ++y) {
    for (int x = 0; x < surface.cols; ++x) {
      const auto id = static_cast<std::uint32_t>(surface(y, x) + 1);
      const std::uint32_t mixed = id * 2654435761u;
      image(y, x) = id == 0 ? cv::Vec3b(0, 0, 0)
                            : cv::Vec3b(static_cast<std::uint8_t>(mixed >> 24),
                                        static_cast<std::uint8_t>(mixed >> 16),
                                        static_cast<std::uint8_t>(mixed >> 8));
    }
  }
  return image;
}

cv::Mat3b EdgeImage(const cv::Mat3b& image,
                    const std::vector<VisibleEdge>& edges) {
  cv::Mat3b drawn;
  image.convertTo(drawn, CV_8U, 0.5, 96.0);
  constexpr int kShift = 4;  // Bits of a fraction of a pixel.
  const auto fixed = [](const Eigen::Vector2d& p) {
    return cv::Point(static_cast<int>(std::lround(p.x() * (1 << kShift))),
                     static_cast<int>(std::lround(p.y() * (1 << kShift))));
  };
  for (const VisibleEdge& edge : edges) {
    for (std::size_t i = 1; i < edge.pixels.size(); ++i) {
      cv::line(drawn,
               fixed(edge.pixels[i - 1]),
               fixed(edge.pixels[i]),
               {40, 30, 200},
               1,
               cv::LINE_AA,
               kShift);
    }
  }
  return drawn;
}

}  // namespace waymark
