#include "drivers/simulator/pattern_boards.h"

#include "drivers/simulator/pattern_canvas.h"
#include "drivers/simulator/pattern_pictures.h"
#include "drivers/simulator/picture_painters.h"

#include <algorithm>
#include <cmath>

namespace waymark {
namespace {

// ---- papers on a noticeboard -----------------------------------------------

constexpr float kInk = 50.0f;

// Lines of words, each a bar: what print looks like from a step away.
void PaintPrint(float line, Random* random, Canvas canvas) {
  const cv::Vec3f ink(kInk, kInk, kInk);
  int left = 3 + static_cast<int>(random->Index(5));  // Lines to the gap.
  for (float y = 0.0f; y + line < canvas.height(); y += line) {
    if (--left < 0) {
      left = 3 + static_cast<int>(random->Index(6));
      continue;
    }
    const float end =
        canvas.width() * (left == 0 ? Between(random, 0.3f, 0.9f) : 1.0f);
    float x = 0.0f;
    while (x < end) {
      const float word = line * Between(random, 0.8f, 3.5f);
      canvas.Box(x,
                 y + 0.25f * line,
                 std::min(word, end - x),
                 0.5f * line,
                 ink * Between(random, 0.8f, 1.6f));
      x += word + 0.5f * line;
    }
  }
}

void PaintLetter(float metre, Random* random, Canvas canvas) {
  const float w = canvas.width();
  const float h = canvas.height();
  const int font = static_cast<int>(random->Index(5));
  const int words = 1 + static_cast<int>(random->Index(2));
  canvas.Text(RandomTitle(words, random),
              {0.08f * w, 0.05f * h, 0.84f * w, 0.11f * h},
              {kInk, kInk, kInk},
              font);
  if (random->Index(2) == 0) {  // A letterhead.
    canvas.Box(0.08f * w,
               0.18f * h,
               0.84f * w,
               0.02f * h,
               ColorOfHue(random->Uniform(), 0.7, 0.6));
  }
  PaintPrint(metre * 0.008f,
             random,
             canvas.Part(0.1f * w, 0.24f * h, 0.8f * w, 0.68f * h));
}

void PaintFlyer(float metre, Random* random, Canvas canvas) {
  const float w = canvas.width();
  const float h = canvas.height();
  const double saturation = random->Uniform(0.1, 0.6);
  canvas.Fill(ColorOfHue(random->Uniform(), saturation, 0.9));
  PaintPicture(random, canvas.Part(0.06f * w, 0.2f * h, 0.88f * w, 0.45f * h));
  const int font = static_cast<int>(random->Index(5));
  const cv::Vec3f color = ColorOfHue(random->Uniform(), 0.8, 0.35);
  canvas.Text(RandomTitle(1, random),
              {0.06f * w, 0.03f * h, 0.88f * w, 0.15f * h},
              color,
              font);
  PaintPrint(metre * 0.011f,
             random,
             canvas.Part(0.1f * w, 0.7f * h, 0.8f * w, 0.26f * h));
}

void PaintTimetable(Random* random, Canvas canvas) {
  const float w = canvas.width();
  const float h = canvas.height();
  const int columns = 4 + static_cast<int>(random->Index(3));
  const int rows = 5 + static_cast<int>(random->Index(5));
  const float cell_w = 0.9f * w / static_cast<float>(columns);
  const float cell_h = 0.8f * h / static_cast<float>(rows);
  canvas.Text(RandomTitle(2, random),
              {0.05f * w, 0.02f * h, 0.9f * w, 0.1f * h},
              {kInk, kInk, kInk},
              1);
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      Canvas cell = canvas.Part(0.05f * w + cell_w * static_cast<float>(column),
                                0.15f * h + cell_h * static_cast<float>(row),
                                cell_w + 1.0f,
                                cell_h + 1.0f);
      if (random->Index(3) == 0) {
        cell.Fill(ColorOfHue(random->Uniform(), 0.5, 0.85));
      }
      cell.Border(1.0f, {90, 90, 90});
    }
  }
}

cv::Mat3b MakePaper(float metre, Random* random) {
  const auto pixels = [&](float size) {
    return std::max(4, static_cast<int>(std::lround(size * metre)));
  };
  const std::uint64_t kind = random->Index(8);
  if (kind == 0) {  // A small coloured note.
    cv::Mat3b note(pixels(0.09f), pixels(0.09f));
    Canvas canvas(note);
    canvas.Fill(ColorOfHue(random->Uniform(0.05, 0.4), 0.5, 0.92));
    PaintPrint(0.016f * metre,
               random,
               canvas.Part(0.1f * canvas.width(),
                           0.2f * canvas.height(),
                           0.8f * canvas.width(),
                           0.7f * canvas.height()));
    return note;
  }
  // A4, upright or not; now and then half or twice of it.
  const float scale = kind == 1 ? 0.71f : kind == 2 ? 1.41f : 1.0f;
  const bool is_upright = random->Index(3) != 0;
  const float shorter = 0.21f * scale;
  const float longer = 0.297f * scale;
  cv::Mat3b paper(pixels(is_upright ? longer : shorter),
                  pixels(is_upright ? shorter : longer));
  Canvas canvas(paper);
  const float white = Between(random, 215.0f, 238.0f);
  canvas.Fill({white, white, white});
  if (kind < 5) {
    PaintLetter(metre, random, canvas);
  } else if (kind < 7) {
    PaintFlyer(metre, random, canvas);
  } else {
    PaintTimetable(random, canvas);
  }
  return paper;
}

}  // namespace

void PaintNoticeboard(const std::optional<cv::Vec3b>& frame,
                      double pixels_per_metre,
                      std::uint64_t seed,
                      cv::Mat3b* image) {
  Random random(seed);
  Canvas canvas(*image);
  const float metre = static_cast<float>(pixels_per_metre);
  const cv::Size size = image->size();
  // Cork, or felt in one of some colours.
  const bool is_cork = random.Index(2) == 0;
  canvas.Fill(is_cork ? cv::Vec3f(98, 142, 178)
                      : ColorOfHue(random.Uniform(), 0.45, 0.5));
  Tone(
      FractalNoise(size, size.width / 12 + 1, size.height / 12 + 1, 3, &random),
      is_cork ? 0.3f : 0.08f,
      image);
  // Papers in cells of about A4's length, each turned and moved a little; only
  // large boards have gaps. Then more over the gaps between them.
  const float cell = 0.27f * metre;
  const int columns = std::max(1, static_cast<int>(canvas.width() / cell));
  const int rows = std::max(1, static_cast<int>(canvas.height() / cell));
  const auto pin = [&](float column, float row, float spread) {
    const float down = Between(&random, -spread, spread);
    const float right = Between(&random, -spread, spread);
    const Eigen::Vector2f middle(
        canvas.width() * (column + right) / static_cast<float>(columns),
        canvas.height() * (row + down) / static_cast<float>(rows));
    const cv::Mat3b paper = MakePaper(metre, &random);
    canvas.Paste(paper, middle, Between(&random, -0.09f, 0.09f));
    const float above = 0.44f * static_cast<float>(paper.rows);
    canvas.Disc(middle - Eigen::Vector2f(0.0f, above),
                0.006f * metre,
                ColorOfHue(random.Uniform(), 0.9, 0.75));
  };
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      if (columns * rows > 6 && random.Index(10) == 0) continue;
      pin(static_cast<float>(column) + 0.5f,
          static_cast<float>(row) + 0.5f,
          0.1f);
    }
  }
  for (int i = 0; i < 1 + columns * rows / 3; ++i) {
    const double row = random.Uniform(0.3, rows - 0.3);
    const double column = random.Uniform(0.3, columns - 0.3);
    pin(static_cast<float>(column), static_cast<float>(row), 0.0f);
  }
  const cv::Vec3f wood = frame ? cv::Vec3f(*frame) : cv::Vec3f(120, 165, 190);
  canvas.Border(0.03f * metre, wood);
  canvas.Border(0.006f * metre, wood * 0.7f);
}

void PaintSign(const std::optional<cv::Vec3b>& plate,
               const std::string& text,
               cv::Mat3b* image) {
  Canvas canvas(*image);
  const cv::Vec3f ground = plate ? cv::Vec3f(*plate) : cv::Vec3f(214, 220, 222);
  const float luma = 0.11f * ground[0] + 0.59f * ground[1] + 0.3f * ground[2];
  const cv::Vec3f ink =
      luma > 120.0f ? cv::Vec3f(42, 34, 30) : cv::Vec3f(232, 234, 236);
  const float side = std::min(canvas.width(), canvas.height());
  canvas.Fill(ground);
  canvas.Border(0.06f * side, Mix(ground, ink, 0.6f));
  std::vector<std::string> lines(1);
  for (const char c : text) {
    if (c == '\n') {
      lines.emplace_back();
    } else {
      lines.back() += c;
    }
  }
  const float margin = 0.14f * side;
  const float tall =
      (canvas.height() - 2.0f * margin) / static_cast<float>(lines.size());
  for (std::size_t i = 0; i < lines.size(); ++i) {
    canvas.Text(lines[i],
                {margin,
                 margin + (static_cast<float>(i) + 0.08f) * tall,
                 canvas.width() - 2.0f * margin,
                 0.84f * tall},
                ink,
                1);
  }
}

void PaintDoor(const std::optional<cv::Vec3b>& wood,
               double pixels_per_metre,
               std::uint64_t seed,
               bool has_handle_left,
               cv::Mat3b* image) {
  Random random(seed);
  Canvas canvas(*image);
  const float metre = static_cast<float>(pixels_per_metre);
  const float w = canvas.width();
  const float h = canvas.height();
  const cv::Vec3f color = wood ? cv::Vec3f(*wood) : cv::Vec3f(108, 150, 184);
  canvas.Fill(color);
  const cv::Size size = image->size();
  Tone(FractalNoise(size, size.width / 8 + 1, 4, 4, &random), 0.13f, image);
  // One panel, two or three, with a bevel lit from above.
  const int panels = 1 + static_cast<int>(random.Index(3));
  const float stile = 0.14f * w;
  const float tall = (h - stile) / static_cast<float>(panels) - stile;
  const float bevel = std::max(1.5f, 0.012f * metre);
  for (int i = 0; i < panels; ++i) {
    const float top = stile + static_cast<float>(i) * (tall + stile);
    const float wide = w - 2.0f * stile;
    canvas.Box(stile, top, wide, bevel, color * 0.55f);
    canvas.Box(stile, top, bevel, tall, color * 0.68f);
    canvas.Box(stile, top + tall - bevel, wide, bevel, color * 1.22f);
    canvas.Box(stile + wide - bevel, top, bevel, tall, color * 1.12f);
  }
  // The handle, 1.05 m above the floor: a plate, a lever, a keyhole.
  const float side = has_handle_left ? -1.0f : 1.0f;
  const float x = has_handle_left ? 0.07f * metre : w - 0.07f * metre;
  const float y = h - 1.05f * metre;
  const cv::Vec3f steel(150, 150, 150);
  canvas.Box(
      x - 0.02f * metre, y - 0.05f * metre, 0.04f * metre, 0.2f * metre, steel);
  canvas.Stroke({x + side * 0.01f * metre, y},
                {x - side * 0.12f * metre, y},
                0.02f * metre,
                steel * 1.35f);
  canvas.Disc({x, y + 0.09f * metre}, 0.008f * metre, {30, 30, 30});
  canvas.Border(std::max(1.0f, 0.004f * metre), color * 0.45f);
}

void PaintNotices(double pixels_per_metre,
                  std::uint64_t seed,
                  cv::Mat3b* image) {
  Random random(seed);
  Canvas canvas(*image);
  const float metre = static_cast<float>(pixels_per_metre);
  const float middle = 0.5f * canvas.width();
  // A large one 1.5 m above the floor, smaller ones below, on either side.
  constexpr float kScale = 1.41f;  // A3 to A4.
  struct Place {
    float x;
    float height;
    float scale;
  };
  for (const Place& place : {Place{0.02f, 1.52f, kScale},
                             Place{-0.14f, 1.12f, 1.0f},
                             Place{0.13f, 0.99f, 0.8f}}) {
    cv::Mat3b paper(static_cast<int>(std::lround(0.297f * place.scale * metre)),
                    static_cast<int>(std::lround(0.21f * place.scale * metre)));
    if (paper.empty()) continue;
    paper.setTo(cv::Scalar::all(230));
    if (random.Index(3) == 0) {
      PaintLetter(metre, &random, Canvas(paper));
    } else {
      PaintFlyer(metre, &random, Canvas(paper));
    }
    const float turn = Between(&random, -0.04f, 0.04f);
    const float right = Between(&random, -0.04f, 0.04f);
    const float up = Between(&random, -0.03f, 0.03f);
    canvas.Paste(paper,
                 {middle + (place.x + right) * metre,
                  canvas.height() - (place.height + up) * metre},
                 turn);
  }
}

}  // namespace waymark
