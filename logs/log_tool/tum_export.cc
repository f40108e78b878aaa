#include "logs/log_tool/tum_export.h"

#include "estimation/base/input_error.h"
#include "logs/log_tool/text_table.h"
#include "processes/support/log_file.h"
#include "processes/support/message_fields.h"
#include "processes/support/output_file.h"
#include "processes/support/progress.h"

#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <optional>
#include <set>

namespace waymark {
namespace {

struct TumPose {
  std::array<double, 3> position{};
  std::array<double, 4> rotation{1.0, 0.0, 0.0, 0.0};  // w, x, y, z.
  bool has_heading = true;
};

void SetHeading(double heading, TumPose* pose) {
  pose->rotation = {std::cos(heading / 2.0), 0.0, 0.0, std::sin(heading / 2.0)};
}

// The top-level numbers of a message, flags as 0 and 1.
class Numbers {
 public:
  void Set(std::string_view name, double value) {
    values_[std::string(name)] = value;
  }
  [[nodiscard]] std::optional<double> Find(const std::string& name) const {
    const auto found = values_.find(name);
    if (found == values_.end()) return std::nullopt;
    return found->second;
  }
  template <std::size_t N>
  [[nodiscard]] std::optional<std::array<double, N>> FindArray(
      const std::string& name) const {
    std::array<double, N> result;
    for (std::size_t i = 0; i < N; ++i) {
      const auto value = Find(name + "[" + std::to_string(i) + "]");
      if (!value) return std::nullopt;
      result[i] = *value;
    }
    return result;
  }

 private:
  std::map<std::string, double> values_;
};

std::optional<TumPose> PlanarPose(const Numbers& numbers) {
  TumPose pose;
  if (const auto planar = numbers.FindArray<3>("pose_W")) {
    pose.position = {(*planar)[0], (*planar)[1], 0.0};
    SetHeading((*planar)[2], &pose);
    return pose;
  }
  const auto x = numbers.Find("x");
  const auto y = numbers.Find("y");
  auto heading = numbers.Find("heading");
  if (!heading) heading = numbers.Find("theta");
  if (!x || !y || !heading) return std::nullopt;
  pose.position = {*x, *y, 0.0};
  pose.has_heading = numbers.Find("has_heading").value_or(1.0) != 0.0;
  if (pose.has_heading) SetHeading(*heading, &pose);
  return pose;
}

std::optional<TumPose> PoseOf(const Numbers& numbers) {
  for (const auto& [position_name, rotation_name] :
       {std::pair("pos", "orientation"), std::pair("trans", "quat")}) {
    const auto position = numbers.FindArray<3>(position_name);
    const auto rotation = numbers.FindArray<4>(rotation_name);
    if (position && rotation) return TumPose{*position, *rotation, true};
  }
  return PlanarPose(numbers);
}

std::string TumLine(std::int64_t utime, const TumPose& pose) {
  // From integers: a double has too few digits for a stamp.
  char line[400];
  const long long micros = utime;
  std::snprintf(line,
                sizeof(line),
                "%s%lld.%06lld %.9g %.9g %.9g %.9g %.9g %.9g %.9g\n",
                micros < 0 ? "-" : "",
                std::llabs(micros / 1'000'000),
                std::llabs(micros % 1'000'000),
                pose.position[0],
                pose.position[1],
                pose.position[2],
                pose.rotation[1],
                pose.rotation[2],
                pose.rotation[3],
                pose.rotation[0]);
  return line;
}

struct Decoded {
  Numbers numbers;
  std::optional<std::int64_t> utime;
};

Decoded Decode(const MessageTypeInfo& type, const LogEvent& event) {
  if (type.schema == nullptr) {
    throw InputError(event.channel + ": its type is not known: " + type.name);
  }
  Decoded result;
  const std::string reason = VisitFields(
      *type.schema,
      event.data,
      [&](std::string_view name, const FieldValue& value) {
        if (const auto* d = std::get_if<double>(&value)) {
          result.numbers.Set(name, *d);
        } else if (const auto* f = std::get_if<float>(&value)) {
          result.numbers.Set(name, static_cast<double>(*f));
        } else if (const auto* b = std::get_if<bool>(&value)) {
          result.numbers.Set(name, *b ? 1.0 : 0.0);
        } else if (const auto* i = std::get_if<std::int64_t>(&value)) {
          if (name == "utime") result.utime = *i;
        }
      });
  if (!reason.empty()) {
    throw InputError(event.channel + ": event " + std::to_string(event.number) +
                     " does not decode as " + type.schema->name + ": " +
                     reason);
  }
  return result;
}

[[noreturn]] void ThrowMissing(const std::string& log,
                               const std::string& channel,
                               const std::set<std::string>& channels) {
  std::string list;
  for (const auto& name : channels) list += (list.empty() ? "" : ", ") + name;
  throw InputError(log + ": has no channel " + channel + ", but " + list);
}

}  // namespace

TumReport ExportTum(const std::string& log,
                    const std::string& channel,
                    const std::string& out,
                    bool by_event_time,
                    TypeTable* types,
                    IfExists if_exists) {
  LogReader reader(log);
  CheckOutput(out, if_exists, {&log, 1});
  Progress progress("exporting " + log, reader.report().num_file_bytes);
  std::optional<OutputFile> file;
  std::set<std::string> channels;
  TumReport report;
  while (const auto event = reader.Next()) {
    progress.Show(reader.offset());
    channels.insert(event->channel);
    if (event->channel != channel) continue;
    const MessageTypeInfo& type = types->Find(event->data);
    const Decoded decoded = Decode(type, *event);
    const auto pose = PoseOf(decoded.numbers);
    if (!pose) {
      throw InputError(channel + ": " + type.schema->name + " holds no pose");
    }
    if (!file) file.emplace(out, if_exists);
    if (decoded.numbers.Find("is_known").value_or(1.0) == 0.0) {
      ++report.num_unknown;
      continue;
    }
    if (!pose->has_heading) ++report.num_no_heading;
    const std::int64_t event_utime = Microseconds(event->time);
    file->Write(TumLine(
        by_event_time ? event_utime : decoded.utime.value_or(event_utime),
        *pose));
    ++report.num_poses;
  }
  if (!file) ThrowMissing(log, channel, channels);
  file->Close();
  return report;
}

}  // namespace waymark
