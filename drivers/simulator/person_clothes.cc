#include "drivers/simulator/person_clothes.h"

#include "drivers/simulator/pattern_canvas.h"
#include "drivers/simulator/pattern_pictures.h"

#include <array>

namespace waymark {
namespace {

cv::Mat3b Cloth(const cv::Vec3f& color, cv::Size size, Random* random) {
  cv::Mat3b cloth(size);
  cloth.setTo(ToPixel(color));
  // Folds and threads.
  Tone(FractalNoise(size, 5, 4, 4, random), 0.16f, &cloth);
  Tone(PeriodicNoise(size, size.width / 2, size.height / 2, random),
       0.07f,
       &cloth);
  return cloth;
}

cv::Vec3f ClothColor(Random* random) {
  const double value = random->Uniform(0.3, 0.75);
  const double saturation = random->Uniform(0.1, 0.5);
  return ColorOfHue(random->Uniform(), saturation, value);
}

void PaintStripes(const cv::Vec3f& color, int stripes, Canvas canvas) {
  const float pitch = canvas.height() / static_cast<float>(stripes);
  for (int i = 0; i < stripes; ++i) {
    canvas.Box(0.0f,
               (static_cast<float>(i) + 0.3f) * pitch,
               canvas.width(),
               0.35f * pitch,
               color);
  }
}

// A jacket over a shirt: lapels, buttons, pockets, a badge; a print behind.
void PaintJacket(const cv::Vec3f& color,
                 const cv::Vec3f& shirt,
                 Random* random,
                 Canvas canvas) {
  const float w = canvas.width();
  const float h = canvas.height();
  const float open = static_cast<float>(random->Uniform(0.25, 0.6)) * h;
  const std::array<Eigen::Vector2f, 3> front{Eigen::Vector2f(0.44f * w, 0.0f),
                                             Eigen::Vector2f(0.56f * w, 0.0f),
                                             Eigen::Vector2f(0.5f * w, open)};
  canvas.Polygon(front, shirt);
  for (const float side : {-1.0f, 1.0f}) {
    const std::array<Eigen::Vector2f, 4> lapel{
        Eigen::Vector2f((0.5f + side * 0.06f) * w, 0.0f),
        Eigen::Vector2f((0.5f + side * 0.1f) * w, 0.3f * open),
        Eigen::Vector2f((0.5f + side * 0.045f) * w, 0.6f * open),
        Eigen::Vector2f(0.5f * w, open)};
    canvas.Polygon(lapel, color * 0.7f);
    canvas.Box((0.5f + side * 0.13f) * w - 0.05f * w,
               0.72f * h,
               0.1f * w,
               0.02f * h,
               color * 0.55f);
  }
  canvas.Stroke({0.5f * w, open}, {0.5f * w, h}, 0.006f * w, color * 0.5f);
  for (float v = open; v < 0.95f * h; v += 0.12f * h) {
    canvas.Disc({0.515f * w, v}, 0.008f * w, color * 0.35f);
  }
  canvas.Box(0.6f * w, 0.3f * h, 0.06f * w, 0.07f * h, shirt);
  canvas.Text(RandomTitle(2, random),
              {0.05f * w, 0.2f * h, 0.14f * w, 0.1f * h},
              shirt,
              1);
}

// A print on the chest and another on the back.
void PaintShirt(const cv::Vec3f& other, Random* random, Canvas canvas) {
  const float w = canvas.width();
  const float h = canvas.height();
  switch (random->Index(3)) {
    case 0:
      PaintStripes(other, 7, canvas);
      break;
    case 1:
      PaintPicture(random,
                   canvas.Part(0.42f * w, 0.22f * h, 0.16f * w, 0.3f * h));
      break;
    default:
      canvas.Box(0.0f, 0.28f * h, w, 0.16f * h, other);
      canvas.Text(RandomTitle(1, random),
                  {0.41f * w, 0.3f * h, 0.18f * w, 0.12f * h},
                  {225, 228, 230},
                  1);
  }
  canvas.Text(RandomWord(random),
              {0.87f * w, 0.15f * h, 0.11f * w, 0.3f * h},
              other,
              1);
}

// u = 0.5 is the middle of the face; the forehead is at v = 0.35, the chin at
// v = 0.8.
cv::Mat3b MakeFace(const cv::Vec3f& skin, const cv::Vec3f& hair) {
  cv::Mat3b face(128, 256, ToPixel(skin));
  Canvas canvas(face);
  const float w = canvas.width();
  const float h = canvas.height();
  for (const float side : {-1.0f, 1.0f}) {
    const float x = (0.5f + side * 0.062f) * w;
    canvas.Box(x - 0.032f * w, 0.405f * h, 0.064f * w, 0.022f * h, hair);
    canvas.Disc({x, 0.475f * h}, 0.03f * h, skin * 0.82f);
    canvas.Box(
        x - 0.024f * w, 0.46f * h, 0.048f * w, 0.03f * h, {228, 230, 232});
    canvas.Disc({x, 0.475f * h}, 0.02f * h, {50, 45, 40});
    canvas.Disc({(0.5f + side * 0.1f) * w, 0.6f * h},
                0.06f * h,
                Mix(skin, {110, 120, 215}, 0.16f));
  }
  canvas.Box(0.48f * w, 0.58f * h, 0.04f * w, 0.02f * h, skin * 0.7f);
  canvas.Box(0.46f * w,
             0.665f * h,
             0.08f * w,
             0.03f * h,
             Mix(skin, {80, 70, 170}, 0.6f));
  canvas.Box(0.46f * w, 0.677f * h, 0.08f * w, 0.007f * h, skin * 0.45f);
  return face;
}

}  // namespace

PersonLook MakePersonLook(std::uint64_t seed) {
  static const std::array<cv::Vec3f, 5> kSkins{cv::Vec3f(165, 190, 226),
                                               cv::Vec3f(140, 172, 214),
                                               cv::Vec3f(105, 145, 192),
                                               cv::Vec3f(72, 104, 148),
                                               cv::Vec3f(52, 74, 108)};
  static const std::array<cv::Vec3f, 5> kHairs{cv::Vec3f(30, 32, 36),
                                               cv::Vec3f(38, 56, 82),
                                               cv::Vec3f(70, 110, 145),
                                               cv::Vec3f(105, 165, 200),
                                               cv::Vec3f(150, 152, 155)};
  Random random(seed);
  PersonLook look;
  const cv::Vec3f skin = kSkins[random.Index(kSkins.size())];
  const cv::Vec3f hair = kHairs[random.Index(kHairs.size())];
  const cv::Vec3f upper = ClothColor(&random);
  const double value = random.Uniform(0.2, 0.5);
  const double saturation = random.Uniform(0.1, 0.5);
  const cv::Vec3f lower =
      ColorOfHue(random.Uniform(0.5, 0.75), saturation, value);
  const cv::Vec3f other = Mix(ClothColor(&random), {225, 228, 230}, 0.5f);
  look.build = static_cast<float>(random.Uniform(0.9, 1.1));
  look.has_long_hair = random.Index(2) == 0;
  const bool has_jacket = random.Index(2) == 0;
  look.has_short_sleeves = !has_jacket && random.Index(2) == 0;

  look.torso = Cloth(upper, {512, 256}, &random);
  if (has_jacket) {
    PaintJacket(upper, other, &random, Canvas(look.torso));
  } else {
    PaintShirt(other, &random, Canvas(look.torso));
  }
  look.sleeve = Cloth(upper, {64, 128}, &random);
  if (random.Index(2) == 0) {
    PaintStripes(other, 2, Canvas(look.sleeve).Part(0, 70, 64, 30));
  }
  look.trousers = Cloth(lower, {128, 256}, &random);
  Canvas trousers(look.trousers);
  // Seams at the sides, a crease at the knee, the hem.
  trousers.Box(31, 0, 2, 256, lower * 0.7f);
  trousers.Box(95, 0, 2, 256, lower * 0.7f);
  trousers.Box(54, 124, 20, 1, lower * 0.85f);
  trousers.Box(0, 246, 128, 2, lower * 0.7f);
  look.shoe = cv::Mat3b(32, 32, ToPixel(ColorOfHue(0.07, 0.4, 0.25)));
  Canvas(look.shoe).Box(11, 0, 10, 32, {185, 190, 195});  // The sole.
  look.skin = cv::Mat3b(1, 1, ToPixel(skin));
  look.face = MakeFace(skin, hair * 0.8f);
  look.hair = cv::Mat3b(64, 128, ToPixel(hair));
  Tone(PeriodicNoise({128, 64}, 50, 3, &random), 0.3f, &look.hair);
  return look;
}

}  // namespace waymark
