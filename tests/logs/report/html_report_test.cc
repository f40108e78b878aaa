#include "logs/report/html_report.h"

#include "logs/report/svg_plot.h"
#include "tests/logs/evaluation/synthetic_log.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cctype>
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
  const std::string page = HtmlReport(evaluations);
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
  const std::string page = HtmlReport({&evaluation, 1});
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

TEST(HtmlReport, SameEvaluationSameBytes) {
  const LogEvaluation a = Evaluate({}, "html_report_test_5");
  const LogEvaluation b = Evaluate({}, "html_report_test_5");
  EXPECT_EQ(HtmlReport({&a, 1}), HtmlReport({&b, 1}));
}

TEST(HtmlReport, NothingToShowIsStillAPage) {
  EXPECT_EQ(NestingMistake(HtmlReport({})), "");
  const LogEvaluation empty = EvaluateRecording({}, {});
  const std::string page = HtmlReport({&empty, 1});
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
