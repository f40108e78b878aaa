#include "logs/report/html_report.h"

#include "estimation/base/input_error.h"
#include "estimation/geometry/angle.h"
#include "logs/report/svg_plot.h"
#include "processes/convert/camera_convert.h"
#include "processes/convert/corridor_convert.h"
#include "processes/support/log_file.h"
#include "processes/support/output_file.h"
#include "tests/logs/evaluation/synthetic_log.h"

#include <waymark/encoders_t.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cctype>
#include <chrono>
#include <filesystem>
#include <limits>
#include <vector>

namespace waymark {
namespace {

using testing::HasSubstr;
using testing::Not;

// First mistake in the nesting of tags, or "". Every tag of the page is closed
// (meta tags by themselves); style sheets hold no '<'.
std::string NestingMistake(const std::string& page) {
  std::vector<std::string> open;
  std::size_t at = 0;
  while ((at = page.find('<', at)) != std::string::npos) {
    const std::size_t end = page.find('>', at);
    if (end == std::string::npos) return "tag without end";
    const std::string tag = page.substr(at + 1, end - at - 1);
    at = end + 1;
    if (tag.empty()) return "empty tag";
    if (tag[0] == '!' || tag.back() == '/') continue;
    const std::size_t name_begin = tag[0] == '/' ? 1 : 0;
    std::size_t name_end = name_begin;
    while (name_end < tag.size() &&
           std::isalnum(static_cast<unsigned char>(tag[name_end])) != 0) {
      ++name_end;
    }
    const std::string name = tag.substr(name_begin, name_end - name_begin);
    if (name_begin == 0) {
      open.push_back(name);
    } else if (open.empty() || open.back() != name) {
      return "</" + name + "> closes " + (open.empty() ? "" : open.back());
    } else {
      open.pop_back();
    }
  }
  return open.empty() ? "" : open.back() + " stays open";
}

LogEvaluation Evaluate(const SyntheticLogOptions& options,
                       const std::string& name) {
  const std::string path =
      (std::filesystem::path(testing::TempDir()) / (name + ".lcm")).string();
  std::filesystem::remove(path);
  WriteSyntheticLog(path, options);
  LogEvaluation evaluation = EvaluateRecording(ReadRecording({&path, 1}), {});
  std::filesystem::remove(path);
  return evaluation;
}

TEST(HtmlReport, IsWellFormedAndStandsAlone) {
  const std::vector<LogEvaluation> evaluations{
      Evaluate({}, "html_report_test_1"),
      Evaluate({.has_truth = false}, "html_report_test_2"),
      Evaluate({.has_estimates = false}, "html_report_test_3")};
  const std::string page = HtmlReport(evaluations, {});
  EXPECT_EQ(NestingMistake(page), "");
  EXPECT_TRUE(page.starts_with("<!DOCTYPE html>"));
  for (const char* outside : {"http:",
                              "https:",
                              "//",
                              "src=",
                              "@import",
                              "url(",
                              "<script",
                              "<link"}) {
    // Comments aside, nothing may be fetched.
    EXPECT_THAT(page, Not(HasSubstr(outside)));
  }
  EXPECT_THAT(page, Not(HasSubstr("nan")));
  EXPECT_THAT(page, Not(HasSubstr("inf,")));
}

TEST(HtmlReport, HasAllSections) {
  const LogEvaluation evaluation = Evaluate({}, "html_report_test_4");
  const std::string page = HtmlReport({&evaluation, 1}, {});
  for (const char* text : {"Summary",
                           "reference-aided",
                           ">Path<",
                           ">Position error<",
                           ">Heading error<",
                           "NEES of the position",
                           ">Wheel base<",
                           ">Right wheel<",
                           ">Left wheel<",
                           ">Health<",
                           "How it was made",
                           "Definitions",
                           "synthetic fault",
                           "html_report_test_4",
                           "prefers-color-scheme: dark",
                           "width=device-width",
                           "online (POSE_SETTLED)",
                           "95 % band",
                           "x, m",
                           "time, s"}) {
    EXPECT_THAT(page, HasSubstr(text));
  }
  // CONFIG is text of others: shown, never interpreted.
  EXPECT_THAT(page, HasSubstr("&lt;b&gt;&amp;"));
}

TEST(HtmlReport, ShowsWhatTheCameraSawAndTheGivenPictures) {
  const std::string path =
      (std::filesystem::path(testing::TempDir()) / "html_report_test_6.lcm")
          .string();
  ImageEncoder encoder({});
  std::string reason;
  {
    LogWriter writer(path, IfExists::kReplace);
    for (int i = 0; i < 101; ++i) {
      const cv::Mat1b image(4, 6, static_cast<std::uint8_t>(2 * i));
      ImageTags tags;
      tags.time = TimeFromMicroseconds(1'700'000'000'000'000 + 100'000 * i);
      writer.Write("IMAGE_FRONT", *encoder.Encode(image, tags, &reason));
    }
    // Others name their channels so too.
    writer.Write("IMAGE_OF_OTHERS", encoders_t{});
    writer.Close();
  }
  const LogEvaluation evaluation =
      EvaluateRecording(ReadRecording({&path, 1}), {});
  std::filesystem::remove(path);
  const std::string page =
      HtmlReport({&evaluation, 1}, {{{"A <plan>", {".png", {0xff, 0xee}}}}});
  EXPECT_EQ(NestingMistake(page), "");
  EXPECT_THAT(page,
              HasSubstr("alt=\"A &lt;plan&gt;\" "
                        "src=\"data:image/png;base64,/+4=\""));
  // From the first to the last, at equal distances.
  for (const char* caption : {">IMAGE_FRONT, 0.0 s<",
                              ">IMAGE_FRONT, 2.0 s<",
                              ">IMAGE_FRONT, 4.0 s<",
                              ">IMAGE_FRONT, 8.0 s<",
                              ">IMAGE_FRONT, 10.0 s<"}) {
    EXPECT_THAT(page, HasSubstr(caption));
  }
  EXPECT_THAT(page, HasSubstr("src=\"data:image/jpeg;base64,/9j/"));
  // Nothing may be fetched.
  for (std::size_t at = 0; (at = page.find("src=", at)) != std::string::npos;
       ++at) {
    EXPECT_TRUE(page.substr(at).starts_with("src=\"data:image/"));
  }
}

// Ten images with an answer each; the third says why it has none.
LogEvaluation SeenOfACorridor() {
  const std::string path =
      (std::filesystem::path(testing::TempDir()) / "html_report_test_8.lcm")
          .string();
  CameraDescription camera;
  camera.size = {64, 48};
  camera.model = PerspectiveCamera(Intrinsics{46.0, 46.0, 31.5, 23.5});
  camera.X_RC.linear() << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  camera.X_RC.translation() << 0.1, 0.0, 0.6;
  ImageEncoder encoder({});
  std::string reason;
  LogWriter writer(path, IfExists::kReplace);
  for (int i = 0; i < 10; ++i) {
    const Time time = TimeFromMicroseconds(1'700'000'000'000'000 + 100'000 * i);
    if (i == 0) {
      writer.Write("CAMERA_INFO_FRONT", ToMessage(camera, "FRONT", time, 0));
    }
    ImageTags tags;
    tags.time = time;
    tags.seq = i < 5 ? i : i + 2;
    writer.Write(
        "IMAGE_FRONT",
        *encoder.Encode(cv::Mat1b(48, 64, std::uint8_t{90}), tags, &reason));
    CorridorAnswer answer;
    answer.time = time;
    answer.source = "FRONT";
    answer.seq = i;
    answer.corridor.emplace().width = 2.0;
    answer.lines_took = std::chrono::microseconds(2000 + i);
    answer.pose_took = std::chrono::microseconds(500);
    CorridorEstimate& estimate = answer.estimate;
    if (i == 2) {
      estimate.status = CorridorStatus::kNoLines;
      estimate.reason = "no <lines> in the image";
    } else {
      estimate.status = CorridorStatus::kAccepted;
      estimate.y = 0.123;
      estimate.heading = RadiansFromDegrees(-4.0);
      estimate.covariance = 1e-4 * Eigen::Matrix2d::Identity();
    }
    writer.Write("CORRIDOR_POSE", ToMessage(answer));
  }
  writer.Close();
  LogEvaluation evaluation = EvaluateRecording(ReadRecording({&path, 1}), {});
  std::filesystem::remove(path);
  return evaluation;
}

TEST(HtmlReport, ShowsWhatWasSeenOfACorridor) {
  const LogEvaluation evaluation = SeenOfACorridor();
  const std::string page = HtmlReport({&evaluation, 1}, {});
  EXPECT_EQ(NestingMistake(page), "");
  for (const char* text : {"Seen of the corridor",
                           "IMAGE_FRONT: 10 images, 2 lost",
                           ">0.0 s: accepted, y +12.3 cm, -4.0°<",
                           ">0.9 s: accepted",
                           "where edges should be",
                           "<td class=\"name\">accepted</td><td>9</td>"
                           "<td>90.0 %</td>",
                           "no &lt;lines&gt; in the image",
                           "to find the lines",
                           "2.00 ms"}) {
    EXPECT_THAT(page, HasSubstr(text));
  }
  // Shown once, with the lines.
  EXPECT_THAT(page, Not(HasSubstr(">IMAGE_FRONT, 0.0 s<")));
  EXPECT_EQ(page, HtmlReport({&evaluation, 1}, {}));
}

TEST(HtmlReport, ShowsImagesWithoutACalibrationAsTheyAre) {
  LogEvaluation evaluation = SeenOfACorridor();
  evaluation.recording.cameras.clear();
  const std::string page = HtmlReport({&evaluation, 1}, {});
  EXPECT_EQ(NestingMistake(page), "");
  EXPECT_THAT(page, HasSubstr("Seen of the corridor"));
  EXPECT_THAT(page, HasSubstr(">IMAGE_FRONT, 0.0 s<"));
}

TEST(LoadReportPicture, RefusesWhatIsNoPicture) {
  const std::string path =
      (std::filesystem::path(testing::TempDir()) / "html_report_test_7.png")
          .string();
  EXPECT_THROW((void)LoadReportPicture(path, ""), InputError);
  {
    OutputFile file(path, IfExists::kReplace);
    file.Write("GIF89a");
    file.Close();
  }
  try {
    (void)LoadReportPicture(path, "");
    FAIL();
  } catch (const InputError& error) {
    EXPECT_EQ(error.what(), path + ": is neither a PNG nor a JPEG");
  }
  std::filesystem::remove(path);
}

TEST(HtmlReport, SameEvaluationSameBytes) {
  const LogEvaluation a = Evaluate({}, "html_report_test_5");
  const LogEvaluation b = Evaluate({}, "html_report_test_5");
  EXPECT_EQ(HtmlReport({&a, 1}, {}), HtmlReport({&b, 1}, {}));
}

TEST(HtmlReport, NothingToShowIsStillAPage) {
  EXPECT_EQ(NestingMistake(HtmlReport({}, {})), "");
  const LogEvaluation empty = EvaluateRecording({}, {});
  const std::string page = HtmlReport({&empty, 1}, {});
  EXPECT_EQ(NestingMistake(page), "");
  EXPECT_THAT(page, HasSubstr("No TRUTH in the log"));
  EXPECT_THAT(page, HasSubstr("no data"));
}

TEST(NestingMistake, IsFound) {
  EXPECT_NE(NestingMistake("<p><b></p></b>"), "");
  EXPECT_NE(NestingMistake("<p>"), "");
  EXPECT_EQ(NestingMistake("<p><i/>text</p>"), "");
}

}  // namespace
}  // namespace waymark
