// Pictures of a world as files, and of what else a renderer knows.
#pragma once

#include "drivers/simulator/scene_edges.h"
#include "processes/support/output_file.h"

#include <opencv2/core/mat.hpp>

#include <string>
#include <vector>

namespace waymark {

// That such a file can be written: .png, or .jpg too where what is in it need
// not be exact. An empty path is no output. Throws InputError, which names
// `option`.
void CheckImageOutput(const std::string& path,
                      const std::string& option,
                      bool is_exact,
                      IfExists if_exists);
// In the format of the path's extension.
void WriteImage(const std::string& path,
                const cv::Mat& image,
                IfExists if_exists);

// Millimetres in 16 bits; 0: nothing met, 65535: so far or farther.
[[nodiscard]] cv::Mat1w DepthImage(const cv::Mat1f& depth);
// A colour for each surface that tells neighbours apart.
[[nodiscard]] cv::Mat3b SurfaceImage(const cv::Mat1i& surface);
// Their lines over the picture, which is faded.
[[nodiscard]] cv::Mat3b EdgeImage(const cv::Mat3b& image,
                                  const std::vector<VisibleEdge>& edges);

}  // namespace waymark
