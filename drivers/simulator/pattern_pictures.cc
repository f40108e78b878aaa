#include "drivers/simulator/pattern_pictures.h"

#include "drivers/simulator/picture_painters.h"

#include <algorithm>
#include <array>

namespace waymark {

void PaintPicture(Random* random, Canvas canvas) {
  using Painter = void (*)(Random*, Canvas);
  static constexpr std::array<Painter, 9> kPainters{PaintShapes,
                                                    PaintMosaic,
                                                    PaintPoster,
                                                    PaintLandscape,
                                                    PaintGlass,
                                                    PaintTriangles,
                                                    PaintSkyline,
                                                    PaintStillLife,
                                                    PaintMap};
  kPainters[random->Index(kPainters.size())](random, canvas);
}

void PaintFramedPicture(const std::optional<cv::Vec3b>& frame,
                        const std::string& title,
                        double pixels_per_metre,
                        std::uint64_t seed,
                        cv::Mat3b* image) {
  Random random(seed);
  Canvas canvas(*image);
  const float metre = static_cast<float>(pixels_per_metre);
  const float side = std::min(canvas.width(), canvas.height());
  static const std::array<cv::Vec3f, 4> kFrames{cv::Vec3f(34, 32, 32),
                                                cv::Vec3f(70, 110, 150),
                                                cv::Vec3f(205, 212, 214),
                                                cv::Vec3f(96, 150, 178)};
  const cv::Vec3f wood =
      frame ? cv::Vec3f(*frame) : kFrames[random.Index(kFrames.size())];
  // A frame of 15 to 35 mm, on a small picture less.
  const float width =
      std::min(metre * Between(&random, 0.015f, 0.035f), 0.08f * side);
  canvas.Fill(wood);
  canvas.Border(0.3f * width, wood * 0.72f);
  Canvas inner = canvas.Part(width,
                             width,
                             canvas.width() - 2.0f * width,
                             canvas.height() - 2.0f * width);
  inner.Fill({222, 228, 230});
  const float mount = random.Index(3) == 0 ? 0.0f : 0.05f * side;
  const float below = title.empty() ? mount : std::max(mount, 0.11f * side);
  Canvas picture = inner.Part(mount,
                              mount,
                              inner.width() - 2.0f * mount,
                              inner.height() - mount - below);
  if (picture.width() > 0.0f && picture.height() > 0.0f) {
    PaintPicture(&random, picture);
    // Print and paper are never quite even.
    const cv::Mat1f noise =
        FractalNoise(picture.image().size(), 6, 6, 4, &random);
    Tone(noise, 0.12f, &picture.image());
  }
  inner.Text(title,
             {mount,
              inner.height() - 0.85f * below,
              inner.width() - 2.0f * mount,
              0.7f * below},
             {40, 38, 36},
             1);
}

}  // namespace waymark
