#include "processes/support/configuration.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <string>
#include <utility>

namespace waymark {
namespace {

enum class Colour { kRed, kGreen };

struct ExampleConfig {
  double window_s = 2.0;
  double tilt_rad = 5.0 * (M_PI / 180.0);
  std::int64_t count = 3;
  bool is_on = true;
  std::string name = "a \"b\": #c";
  std::vector<double> start;
  std::vector<double> weights = {0.1, 1e-9};
  Colour colour = Colour::kGreen;
  double probability = 0.99;
  double sigma = 0.5;

  void Describe(Describer& d) {
    d.Number("window_s", &window_s, {0.0, 30.0}, "How long to wait");
    d.Degrees("tilt_deg", &tilt_rad, {-90.0, 90.0}, "Tilt | up");
    d.Integer("count", &count, 1, 10, "How many");
    d.Flag("is_on", &is_on, "Whether");
    d.Text("name", &name, "Who");
    d.Numbers("start", &start, 3, "Where; empty: unknown");
    d.Numbers("weights", &weights, -1, "Weights");
    d.Choice("colour",
             &colour,
             {{"red", Colour::kRed}, {"green", Colour::kGreen}},
             "Which");
    d.Group(
        "gate",
        [&] {
          d.Number("probability", &probability, {0.5, 1.0}, "Of passing");
          d.Group(
              "inner",
              [&] { d.Number("sigma", &sigma, kPositive, "Spread"); },
              "");
        },
        "The gate");
  }
  void Check() const {
    if (count == 7) throw std::invalid_argument("count = 7: is unlucky");
  }
};

DescribeFunction DescribeOf(ExampleConfig* config) {
  return [config](Describer& d) { config->Describe(d); };
}

std::string ErrorOf(const std::string& yaml) {
  ExampleConfig config;
  try {
    LoadConfigurationText(yaml, "example.yaml", DescribeOf(&config));
  } catch (const InputError& error) {
    return error.what();
  }
  return "none";
}

std::string SettingError(const std::string& setting) {
  ExampleConfig config;
  try {
    ApplySetting(setting, DescribeOf(&config));
  } catch (const InputError& error) {
    return error.what();
  }
  return "none";
}

TEST(Configuration, LoadsWhatIsGivenAndKeepsTheRest) {
  ExampleConfig config;
  LoadConfigurationText(
      "# comment\n"
      "window_s: 1.5\n"
      "tilt_deg: 180e-1\n"
      "count: +4\n"
      "is_on: false\n"
      "name: 5\n"
      "start: [1, -2.5, 3]\n"
      "weights: []\n"
      "colour: red\n"
      "gate:\n"
      "  inner: {sigma: 1e-3}\n",
      "example.yaml",
      DescribeOf(&config));
  EXPECT_EQ(config.window_s, 1.5);
  EXPECT_DOUBLE_EQ(config.tilt_rad, 18.0 * M_PI / 180.0);
  EXPECT_EQ(config.count, 4);
  EXPECT_FALSE(config.is_on);
  EXPECT_EQ(config.name, "5");
  EXPECT_EQ(config.start, (std::vector<double>{1.0, -2.5, 3.0}));
  EXPECT_TRUE(config.weights.empty());
  EXPECT_EQ(config.colour, Colour::kRed);
  EXPECT_EQ(config.probability, 0.99);
  EXPECT_EQ(config.sigma, 1e-3);
}

TEST(Configuration, EmptyTextKeepsEverything) {
  EXPECT_EQ(ErrorOf(""), "none");
  EXPECT_EQ(ErrorOf("# nothing\n"), "none");
  EXPECT_EQ(ErrorOf("gate:\n"), "none");
  EXPECT_EQ(ErrorOf("start: []\n"), "none");
}

TEST(Configuration, UnknownKeyIsNamedWithItsLine) {
  EXPECT_EQ(ErrorOf("window_s: 1\nwindow: 2\n"),
            "example.yaml:2: window: unknown key; known here: window_s, "
            "tilt_deg, count, is_on, name, start, weights, colour, gate");
  EXPECT_EQ(ErrorOf("gate:\n  probability: 0.9\n  sigma: 2\n"),
            "example.yaml:3: gate.sigma: unknown key; known here: "
            "probability, inner");
  EXPECT_EQ(ErrorOf("gate: {inner: {s: 2}}\n"),
            "example.yaml:1: gate.inner.s: unknown key; known here: sigma");
}

TEST(Configuration, KeyGivenTwiceIsRefused) {
  EXPECT_EQ(ErrorOf("count: 1\nis_on: true\ncount: 1\n"),
            "example.yaml:3: count: given twice");
  EXPECT_EQ(ErrorOf("gate:\n  inner:\n    sigma: 1\n    sigma: 1\n"),
            "example.yaml:4: gate.inner.sigma: given twice");
}

TEST(Configuration, WrongTypeIsRefused) {
  EXPECT_EQ(ErrorOf("window_s: soon\n"),
            "example.yaml:1: window_s = soon: must be a number in [0, 30]");
  EXPECT_EQ(ErrorOf("window_s: \"5\"\n"),
            "example.yaml:1: window_s = \"5\": must be a number in [0, 30]");
  EXPECT_EQ(ErrorOf("window_s: 5s\n"),
            "example.yaml:1: window_s = 5s: must be a number in [0, 30]");
  EXPECT_EQ(ErrorOf("window_s:\n"),
            "example.yaml:1: window_s = nothing: must be a number in [0, 30]");
  EXPECT_EQ(ErrorOf("window_s: [1]\n"),
            "example.yaml:1: window_s = a list of 1: must be a number in "
            "[0, 30]");
  EXPECT_EQ(ErrorOf("count: 1.5\n"),
            "example.yaml:1: count = 1.5: must be a whole number in [1, 10]");
  EXPECT_EQ(ErrorOf("is_on: yes\n"),
            "example.yaml:1: is_on = yes: must be true or false");
  EXPECT_EQ(ErrorOf("is_on: \"true\"\n"),
            "example.yaml:1: is_on = \"true\": must be true or false");
  EXPECT_EQ(ErrorOf("name: [a]\n"),
            "example.yaml:1: name = a list of 1: must be text");
  EXPECT_EQ(ErrorOf("start: [1, 2]\n"),
            "example.yaml:1: start = a list of 2: must be a list of 3 numbers");
  EXPECT_EQ(ErrorOf("start: 1\n"),
            "example.yaml:1: start = 1: must be a list of 3 numbers");
  EXPECT_EQ(ErrorOf("start: [1, x, 2]\n"),
            "example.yaml:1: start[1] = x: must be a number");
  EXPECT_EQ(ErrorOf("colour: blue\n"),
            "example.yaml:1: colour = blue: must be one of: red, green");
  EXPECT_EQ(ErrorOf("\ngate: 5\n"),
            "example.yaml:2: gate = 5: must be a group of keys");
  EXPECT_EQ(ErrorOf("- 5\n"),
            "example.yaml: must be a list of 'key: value' lines");
  EXPECT_EQ(ErrorOf("[1, 2]: 3\n"),
            "example.yaml:1: a key must be a plain word");
}

TEST(Configuration, OutOfRangeIsRefused) {
  EXPECT_EQ(ErrorOf("window_s: -0.1\n"),
            "example.yaml:1: window_s = -0.1: must be a number in [0, 30]");
  EXPECT_EQ(ErrorOf("window_s: 1e999\n"),
            "example.yaml:1: window_s = 1e999: must be a number in [0, 30]");
  EXPECT_EQ(ErrorOf("window_s: nan\n"),
            "example.yaml:1: window_s = nan: must be a number in [0, 30]");
  EXPECT_EQ(ErrorOf("tilt_deg: 91\n"),
            "example.yaml:1: tilt_deg = 91: must be a number in [-90, 90]");
  EXPECT_EQ(ErrorOf("count: 11\n"),
            "example.yaml:1: count = 11: must be a whole number in [1, 10]");
  EXPECT_EQ(ErrorOf("count: 99999999999999999999\n"),
            "example.yaml:1: count = 99999999999999999999: must be a whole "
            "number in [1, 10]");
  EXPECT_EQ(ErrorOf("gate:\n  inner:\n    sigma: 0\n"),
            "example.yaml:3: gate.inner.sigma = 0: must be a number > 0");
  EXPECT_EQ(ErrorOf("weights: [1, inf]\n"),
            "example.yaml:1: weights[1] = inf: must be a number");
}

TEST(Configuration, BadYamlIsOneLine) {
  EXPECT_EQ(ErrorOf("window_s: 1\nstart: [1,\n"),
            "example.yaml:3: end of sequence flow not found");
  EXPECT_EQ(ErrorOf("window_s: 1\n---\nwindow_s: 2\n"),
            "example.yaml: must be one YAML document");
  // yaml-cpp's LoadAll() reports documents without end here.
  EXPECT_EQ(ErrorOf(",a=[0]"), "example.yaml: must be one YAML document");
  EXPECT_EQ(SettingError("count=,5"),
            "--set count=,5: must be one YAML document");
}

TEST(Configuration, FileThatCannotBeReadIsNamed) {
  ExampleConfig config;
  try {
    LoadConfigurationFile("/nowhere/x.yaml", DescribeOf(&config));
    FAIL();
  } catch (const InputError& error) {
    EXPECT_STREQ(
        error.what(),
        "/nowhere/x.yaml: cannot be opened: No such file or directory");
  }
  EXPECT_THROW(LoadConfigurationFile("/tmp", DescribeOf(&config)), InputError);
}

TEST(Configuration, FilesWithoutAnEndAreRefused) {
  ExampleConfig config;
  const std::string path = testing::TempDir() + "configuration_long.yaml";
  std::ofstream(path) << "";
  std::filesystem::resize_file(path, (16 << 20) + 1);
  for (const auto& [file, reason] :
       {std::pair<std::string, std::string>{"/dev/zero",
                                            "is longer than 16777216 bytes"},
        {path, "is longer than 16777216 bytes"}}) {
    try {
      LoadConfigurationFile(file, DescribeOf(&config));
      ADD_FAILURE() << file;
    } catch (const InputError& error) {
      EXPECT_EQ(error.what(), file + ": " + reason);
    }
  }
  std::filesystem::remove(path);
}

TEST(Configuration, SettingsOverrideTheFile) {
  const std::string path = testing::TempDir() + "configuration_test.yaml";
  std::ofstream(path) << "window_s: 1\ncount: 2\n";
  ExampleConfig config;
  LoadConfiguration(
      path, {"window_s=3", "gate.inner.sigma=2", "start=[1, 2, 3]"}, &config);
  EXPECT_EQ(config.window_s, 3.0);
  EXPECT_EQ(config.count, 2);
  EXPECT_EQ(config.sigma, 2.0);
  EXPECT_EQ(config.start.size(), 3u);
  std::remove(path.c_str());
}

TEST(Configuration, SettingOfNothingIsTheEmptyText) {
  ExampleConfig config;
  config.name = "before";
  LoadConfiguration("", {"name="}, &config);
  EXPECT_EQ(config.name, "");
  EXPECT_NE(SettingError("window_s=").find("must be a number in [0, 30]"),
            std::string::npos);
}

TEST(Configuration, BadSettingIsOneLine) {
  EXPECT_EQ(SettingError("window_s"),
            "--set window_s: must be key=value, group.key=value");
  EXPECT_EQ(SettingError("window_s=x"),
            "--set window_s=x: window_s = x: must be a number in [0, 30]");
  EXPECT_EQ(SettingError("gate.x=1"),
            "--set gate.x=1: gate.x: unknown key; known here: probability, "
            "inner");
  EXPECT_EQ(SettingError("window_s.x=1"),
            "--set window_s.x=1: window_s = a group: must be a number in "
            "[0, 30]");
  EXPECT_EQ(SettingError("gate=1"),
            "--set gate=1: gate = 1: must be a group of keys");
  EXPECT_EQ(SettingError("start=[1"),
            "--set start=[1: end of sequence flow not found");
}

TEST(Configuration, OwnCheckIsOneLine) {
  ExampleConfig config;
  try {
    LoadConfiguration("", {"count=7"}, &config);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_STREQ(error.what(),
                 "configuration with --set: count = 7: is unlucky");
  }
}

TEST(Configuration, PrintedValuesLoadBackBitForBit) {
  ExampleConfig config;
  config.window_s = 1.0 / 3.0;
  config.sigma = 5e-324 + 1e-300;
  config.name = "line\nwith \\ \"quotes\" and \xc3\xa4: [1, {2";
  config.start = {0.1, 0.2, -1e22};
  // Odd: angles that were given in degrees. Even: no number of degrees need
  // convert to them, so the last place may move.
  for (int i = 1; i < 900; ++i) {
    config.tilt_rad = i % 2 == 0 ? i * 0.000777 : i * 0.1 * (M_PI / 180.0);
    const std::string yaml = PrintConfiguration(DescribeOf(&config));
    ExampleConfig loaded;
    LoadConfigurationText(yaml, "printed", DescribeOf(&loaded));
    if (i % 2 == 0) {
      ASSERT_DOUBLE_EQ(loaded.tilt_rad, config.tilt_rad) << yaml;
    } else {
      ASSERT_EQ(loaded.tilt_rad, config.tilt_rad) << yaml;
    }
    ASSERT_EQ(loaded.window_s, config.window_s);
    ASSERT_EQ(loaded.sigma, config.sigma);
    ASSERT_EQ(loaded.name, config.name);
    ASSERT_EQ(loaded.start, config.start);
    ASSERT_EQ(loaded.weights, config.weights);
    ASSERT_EQ(PrintConfiguration(DescribeOf(&loaded)), yaml);
  }
}

TEST(Configuration, ReferenceListsEveryKey) {
  ExampleConfig config;
  EXPECT_EQ(
      DescribeConfiguration(DescribeOf(&config)),
      "| key | default | allowed | meaning |\n"
      "|---|---|---|---|\n"
      "| `window_s` | `2` | number in [0, 30] | How long to wait |\n"
      "| `tilt_deg` | `5` | number in [-90, 90] | Tilt \\| up |\n"
      "| `count` | `3` | whole number in [1, 10] | How many |\n"
      "| `is_on` | `true` | true, false | Whether |\n"
      "| `name` | `\"a \\\"b\\\": #c\"` | text | Who |\n"
      "| `start` | `[]` | list of 3 numbers | Where; empty: unknown |\n"
      "| `weights` | `[0.1, 1e-09]` | list of numbers | Weights |\n"
      "| `colour` | `green` | red, green | Which |\n"
      "| **`gate`** |  |  | The gate |\n"
      "| `gate.probability` | `0.99` | number in [0.5, 1] | Of passing |\n"
      "| `gate.inner.sigma` | `0.5` | number > 0 | Spread |\n");
}

}  // namespace
}  // namespace waymark
