#include "logs/report/corridor_section.h"

#include "estimation/geometry/angle.h"
#include "logs/evaluation/evaluation_text.h"
#include "logs/report/corridor_picture.h"
#include "logs/report/evaluation_plots.h"
#include "logs/report/html_parts.h"
#include "logs/report/svg_plot.h"
#include "processes/support/channels.h"

#include <fmt/format.h>
#include <opencv2/imgcodecs.hpp>

#include <algorithm>
#include <optional>
#include <utility>
#include <vector>

namespace waymark {
namespace {

constexpr int kJpegQuality = 88;

std::string ChannelOf(const CorridorAnswer& answer) {
  return std::string(kImagePrefix) + answer.source;
}

const CorridorAnswer* AnswerTo(const LogRecording& recording,
                               const RecordedPicture& picture) {
  for (const CorridorAnswer& answer : recording.corridor) {
    if (answer.time == picture.time && ChannelOf(answer) == picture.channel) {
      return &answer;
    }
  }
  return nullptr;
}

std::string SignedCentimetres(double metres) {
  return fmt::format("{:+.1f} cm", 100.0 * metres);
}

std::string CaptionOf(const CorridorEstimate& estimate, double seconds) {
  std::string text =
      fmt::format("{:.1f} s: {}", seconds, NameOf(estimate.status));
  if (estimate.y) text += ", y " + SignedCentimetres(*estimate.y);
  if (estimate.heading) {
    text += fmt::format(", {:+.1f}°", DegreesFromRadians(*estimate.heading));
  }
  return text;
}

// The recorded image with what was seen in it; itself where it is no image.
ImageFile DrawnFile(const RecordedPicture& picture,
                    const CameraDescription& camera,
                    const CorridorAnswer& answer) {
  const cv::Mat image = cv::imdecode(picture.file.bytes, cv::IMREAD_COLOR);
  if (image.empty()) return picture.file;
  const CorridorScene scene{
      camera.model,
      picture.head
          ? MountOf(camera).CameraOnRobot(picture.head->pan, picture.head->tilt)
          : camera.X_RC,
      answer.corridor};
  ImageFile file{".jpg", {}};
  cv::imencode(".jpg",
               DrawCorridor(image, answer.estimate, scene),
               file.bytes,
               {cv::IMWRITE_JPEG_QUALITY, kJpegQuality});
  return file;
}

std::string LegendEntry(const PictureColor& color,
                        int width,
                        const std::string& text) {
  return fmt::format(
      "<li><svg viewBox=\"0 0 22 10\"><line x1=\"0\" y1=\"5\" x2=\"22\" "
      "y2=\"5\" stroke=\"#{:02x}{:02x}{:02x}\" "
      "stroke-width=\"{}\"/></svg>{}</li>\n",
      color[0],
      color[1],
      color[2],
      width,
      text);
}

std::string Legend() {
  const PictureColor along = ColorOf(LineUse::kAlong);
  return "<ul class=\"legend\">\n" +
         LegendEntry(along, 4, "along the corridor, supports the position") +
         LegendEntry(along, 1, "along it, only the heading") +
         LegendEntry(ColorOf(LineUse::kAcross), 2, "across it") +
         LegendEntry(ColorOf(LineUse::kVertical), 2, "vertical") +
         LegendEntry(ColorOf(LineUse::kOther), 2, "others") +
         LegendEntry(kPredictedColor, 7, "where edges should be") +
         LegendEntry(kVanishingColor, 4, "ring: where the axis vanishes") +
         "</ul>\n";
}

std::string Pictures(const LogEvaluation& evaluation) {
  const LogRecording& recording = evaluation.recording;
  std::string figures;
  const Time start =
      recording.pictures.empty() ? Time{} : recording.pictures.front().time;
  for (const RecordedPicture& picture : recording.pictures) {
    if (!ShowsLinesOf(evaluation, picture.channel)) continue;
    const double seconds = Seconds(picture.time - start);
    const CorridorAnswer* answer = AnswerTo(recording, picture);
    figures += answer == nullptr
                   ? HtmlFigure(fmt::format("{:.1f} s: no answer", seconds),
                                picture.file)
                   : HtmlFigure(CaptionOf(answer->estimate, seconds),
                                DrawnFile(picture,
                                          recording.cameras.at(picture.channel),
                                          *answer));
  }
  if (figures.empty()) return "";
  return Legend() + "<div class=\"plots three\">\n" + figures + "</div>\n";
}

std::string StatusTable(const CorridorEvaluation& corridor) {
  std::vector<std::pair<std::string, int>> statuses(corridor.statuses.begin(),
                                                    corridor.statuses.end());
  std::stable_sort(
      statuses.begin(), statuses.end(), [](const auto& a, const auto& b) {
        return a.second > b.second;
      });
  std::vector<std::vector<Cell>> rows{
      {{"answer", ""}, {"images", ""}, {"share", ""}, {"why (the last)", ""}}};
  for (const auto& [status, num] : statuses) {
    const auto reason = corridor.reasons.find(status);
    rows.push_back({{status, "name"},
                    {std::to_string(num), ""},
                    {PercentText(static_cast<double>(num) / corridor.num), ""},
                    {reason == corridor.reasons.end() || reason->second.empty()
                         ? "–"
                         : reason->second,
                     ""}});
  }
  return HtmlTable(rows);
}

std::vector<Cell> TimeRow(const std::string& name,
                          double median,
                          double p95,
                          double max) {
  const auto cell = [](double ms) {
    return Cell{fmt::format("{:.2f} ms", ms), ""};
  };
  return {{name, "name"}, cell(median), cell(p95), cell(max)};
}

std::string TimeTable(const LogEvaluation& evaluation) {
  std::vector<std::vector<Cell>> rows{
      {{"time", ""}, {"median", ""}, {"p95", ""}, {"max", ""}}};
  const auto add = [&](const char* name,
                       const std::optional<LatencySummary>& l) {
    if (l) rows.push_back(TimeRow(name, l->median_ms, l->p95_ms, l->max_ms));
  };
  const CorridorEvaluation& corridor = *evaluation.corridor;
  if (corridor.lines_ms.num > 0) {
    for (const auto& [name, s] :
         {std::pair("to find the lines", &corridor.lines_ms),
          std::pair("to the pose from them", &corridor.pose_ms)}) {
      rows.push_back(TimeRow(name, s->median, s->p95, s->max));
    }
  }
  const LogRecording& recording = evaluation.recording;
  const auto latency = recording.latency.find(std::string(kCorridorPose));
  if (latency != recording.latency.end()) {
    add("from the image to CORRIDOR_POSE", latency->second);
  }
  if (recording.sight) {
    add("from its exposure to CORRIDOR_POSE", recording.sight->to_answer);
    add("from its exposure to the next POSE", recording.sight->to_pose);
  }
  return rows.size() > 1 ? HtmlTable(rows) : std::string();
}

std::string SightText(const std::optional<SightHealth>& sight) {
  if (!sight) return "";
  return fmt::format(
      "<p>{}: {} images, {} lost (gaps in their numbers), {} without an "
      "answer.</p>\n",
      EscapeHtml(sight->channel),
      sight->num_images,
      sight->num_lost,
      sight->num_unanswered);
}

}  // namespace

bool ShowsLinesOf(const LogEvaluation& evaluation, const std::string& channel) {
  const LogRecording& recording = evaluation.recording;
  return evaluation.corridor && recording.sight &&
         recording.sight->channel == channel &&
         recording.cameras.contains(channel);
}

std::string CorridorSection(const LogEvaluation& evaluation) {
  if (!evaluation.corridor) return "";
  return "<h3>Seen of the corridor</h3>\n" +
         SightText(evaluation.recording.sight) + Pictures(evaluation) +
         "<div class=\"plots\">\n" + FigureOf(CorridorPlot(evaluation)) +
         "</div>\n" + StatusTable(*evaluation.corridor) + TimeTable(evaluation);
}

}  // namespace waymark
