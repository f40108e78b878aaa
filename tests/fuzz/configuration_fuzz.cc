// YAML configuration and --set: refused in one line, or loaded into values
// that print and load back to the same.
#include "processes/support/configuration.h"
#include "tests/fuzz/fuzz_target.h"

#include <cmath>

namespace waymark::fuzz {
namespace {

struct Settings {
  double window_s = 2.0;
  double turn_rad = 0.1;
  std::int64_t count = 3;
  bool active = true;
  std::string name = "robot";
  std::vector<double> start = {};
  std::vector<double> pose = {1, 2, 3};
  int kind = 1;
  double gate = 9.0;

  void Describe(Describer& d) {
    d.Number("window_s", &window_s, {0.0, 30.0}, "window");
    d.Degrees("turn_deg", &turn_rad, {-90.0, 90.0}, "turn");
    d.Integer("count", &count, 0, 100, "count");
    d.Flag("active", &active, "whether");
    d.Text("name", &name, "name");
    d.Numbers("start", &start, -1, "any number");
    d.Numbers("pose", &pose, 3, "three");
    d.ChoiceIndex("kind", &kind, {"online", "batch"}, "which");
    d.Group(
        "filter",
        [&] { d.Number("gate", &gate, kPositive, "gate"); },
        "the filter");
  }
};

DescribeFunction Describing(Settings* settings) {
  return [settings](Describer& d) { settings->Describe(d); };
}

void CheckRanges(const Settings& s) {
  Expect(s.window_s >= 0.0 && s.window_s <= 30.0, "number in range");
  Expect(s.count >= 0 && s.count <= 100, "integer in range");
  Expect(s.kind == 0 || s.kind == 1, "choice in range");
  Expect(s.gate > 0.0 && std::isfinite(s.gate), "positive");
  Expect(std::abs(s.turn_rad) <= 1.5708, "angle in range");
  Expect(s.pose.size() == 3, "size kept");
  for (const double value : s.start) Expect(std::isfinite(value), "finite");
}

void CheckPrintsAndLoads(Settings settings) {
  const std::string printed = PrintConfiguration(Describing(&settings));
  Settings again;
  LoadConfigurationText(printed, "printed", Describing(&again));
  Expect(PrintConfiguration(Describing(&again)) == printed,
         "prints and loads back: " + printed);
}

}  // namespace

// The first byte chooses: a text, or a setting.
void RunOne(Bytes data) {
  if (data.empty()) return;
  const std::string_view text = Text(data.subspan(1));
  Settings settings;
  const bool taken = TakesOrRefuses([&] {
    if (data[0] % 2 == 0) {
      LoadConfigurationText(text, "fuzz.yaml", Describing(&settings));
    } else {
      ApplySetting(text, Describing(&settings));
    }
  });
  if (!taken) return;
  CheckRanges(settings);
  CheckPrintsAndLoads(settings);
}

std::vector<std::string> Seeds() {
  Settings settings;
  const std::string text(1, '\0');
  return {
      text + PrintConfiguration(Describing(&settings)),
      text + "filter: {gate: 3.5}\nstart: [1, -2e3, .5]\n",
      text + "name: \"a # b\\n\"\nkind: batch\nactive: no\n# comment\n",
      text + "a: &x [1]\nb: *x\n<<: {c: 1}\n",
      text + "window_s: 1\nwindow_s: 2\n",
      text + "count: !!int 5\nname: |\n  lines\n  more\n",
      "1filter.gate=4",
      "1name=a: b",
      "1pose=[1,2,3]",
      "1turn_deg=-45.5",
      "1start=[]",
  };
}

}  // namespace waymark::fuzz
