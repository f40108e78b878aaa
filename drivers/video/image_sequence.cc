#include "drivers/video/image_sequence.h"

#include "drivers/video/image_file.h"
#include "estimation/base/input_error.h"

#include <glob.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>
#include <system_error>
#include <utility>

namespace waymark {
namespace {

namespace fs = std::filesystem;
using Entries = std::vector<ImageSequence::Entry>;

constexpr double kDefaultRateHz = 10.0;
// Less is a number of a frame, not a time.
constexpr std::int64_t kMinNanoseconds = 100'000;

bool IsImageName(const fs::path& path) {
  static constexpr std::array<std::string_view, 8> kExtensions{
      ".jpg", ".jpeg", ".png", ".bmp", ".pgm", ".ppm", ".tif", ".tiff"};
  std::string extension = path.extension().string();
  for (char& c : extension) {
    c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  }
  return std::find(kExtensions.begin(), kExtensions.end(), extension) !=
         kExtensions.end();
}

// "frame9" before "frame10".
bool IsBefore(const std::string& a, const std::string& b) {
  const auto is_digit = [](char c) {
    return std::isdigit(static_cast<unsigned char>(c)) != 0;
  };
  std::size_t i = 0;
  std::size_t k = 0;
  while (i < a.size() && k < b.size()) {
    if (!is_digit(a[i]) || !is_digit(b[k])) {
      if (a[i] != b[k]) return a[i] < b[k];
      ++i;
      ++k;
      continue;
    }
    const auto number = [&](const std::string& s, std::size_t* at) {
      std::size_t begin = *at;
      while (*at < s.size() && is_digit(s[*at])) ++*at;
      while (begin + 1 < *at && s[begin] == '0') ++begin;
      return s.substr(begin, *at - begin);
    };
    const std::string x = number(a, &i);
    const std::string y = number(b, &k);
    if (x.size() != y.size()) return x.size() < y.size();
    if (x != y) return x < y;
  }
  return a.size() - i < b.size() - k;
}

std::vector<std::string> PathsOf(const std::string& source) {
  std::vector<std::string> paths;
  std::error_code error;
  if (fs::is_directory(source, error)) {
    for (const auto& item : fs::directory_iterator(source, error)) {
      if (IsImageName(item.path())) paths.push_back(item.path().string());
    }
    if (error) throw InputError(source + ": " + error.message());
  } else {
    glob_t found{};
    ::glob(source.c_str(), 0, nullptr, &found);
    for (std::size_t i = 0; i < found.gl_pathc; ++i) {
      paths.emplace_back(found.gl_pathv[i]);
    }
    ::globfree(&found);
  }
  if (paths.empty()) throw InputError(source + ": no images there");
  std::sort(paths.begin(), paths.end(), [](const auto& a, const auto& b) {
    // By value alone "07" and "7" would be equal.
    return IsBefore(a, b) || (!IsBefore(b, a) && a < b);
  });
  return paths;
}

// ---- times -----------------------------------------------------------------

// Whole nanoseconds of all names, in their order; empty where they are none.
std::vector<std::int64_t> TimesOfNames(const std::vector<std::string>& paths) {
  std::vector<std::int64_t> times;
  for (const std::string& path : paths) {
    const std::string stem = fs::path(path).stem().string();
    std::int64_t time = 0;
    const auto [end, error] =
        std::from_chars(stem.data(), stem.data() + stem.size(), time);
    if (error != std::errc() || end != stem.data() + stem.size()) return {};
    if (!times.empty() && time - times.back() < kMinNanoseconds) return {};
    times.push_back(time);
  }
  if (times.size() < 2 || times.front() < 0) return {};
  return times;
}

struct TimesLine {
  double seconds = 0.0;
  std::string name;  // May be empty.
};

std::vector<TimesLine> ReadTimesFile(const std::string& path) {
  std::ifstream in(path);
  if (!in) throw InputError(path + ": cannot be read");
  std::vector<TimesLine> lines;
  std::string text;
  for (int number = 1; std::getline(in, text); ++number) {
    text = text.substr(0, text.find('#'));
    std::replace(text.begin(), text.end(), ',', ' ');
    std::istringstream words(text);
    std::string time;
    TimesLine line;
    if (!(words >> time)) continue;
    words >> line.name;
    const auto refuse = [&](const char* why) {
      std::ostringstream out;
      out << path << ':' << number << ": time '" << time << "' " << why;
      throw InputError(out.str());
    };
    const auto [end, error] =
        std::from_chars(time.data(), time.data() + time.size(), line.seconds);
    // Up to the year 2286; more is no time in seconds.
    constexpr double kMaxSeconds = 1e10;
    if (error != std::errc() || end != time.data() + time.size() ||
        !(std::abs(line.seconds) < kMaxSeconds)) {
      refuse("must be a number of seconds");
    }
    if (!lines.empty() && !(line.seconds > lines.back().seconds)) {
      refuse("must be above the one before");
    }
    if (!lines.empty() && line.name.empty() != lines.back().name.empty()) {
      refuse("has a name where others have none, or the other way round");
    }
    lines.push_back(line);
  }
  if (lines.empty()) throw InputError(path + ": no times in it");
  return lines;
}

Entries EntriesOfTimesFile(const std::string& times_file,
                           const std::vector<std::string>& paths) {
  const std::vector<TimesLine> lines = ReadTimesFile(times_file);
  std::map<std::string, std::string> by_name;
  for (const std::string& path : paths) {
    by_name.emplace(fs::path(path).filename().string(), path);
  }
  const bool has_names = !lines.front().name.empty();
  if (!has_names && lines.size() != paths.size()) {
    throw InputError(times_file + ": " + std::to_string(lines.size()) +
                     " times for " + std::to_string(paths.size()) + " images");
  }
  Entries entries;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    ImageSequence::Entry entry;
    entry.time = DurationFromSeconds(lines[i].seconds - lines.front().seconds);
    if (has_names) {
      const auto found =
          by_name.find(fs::path(lines[i].name).filename().string());
      if (found == by_name.end()) {
        throw InputError(times_file + ": no such image: " + lines[i].name);
      }
      entry.path = found->second;
    } else {
      entry.path = paths[i];
    }
    entries.push_back(std::move(entry));
  }
  return entries;
}

}  // namespace

ImageSequence::ImageSequence(const std::string& source,
                             const std::string& times_file,
                             double rate_hz) {
  const std::vector<std::string> paths = PathsOf(source);
  if (!times_file.empty()) {
    entries_ = EntriesOfTimesFile(times_file, paths);
    return;
  }
  const std::vector<std::int64_t> times = TimesOfNames(paths);
  const double rate = rate_hz > 0.0 ? rate_hz : kDefaultRateHz;
  for (std::size_t i = 0; i < paths.size(); ++i) {
    const Duration time =
        times.empty() ? DurationFromSeconds(static_cast<double>(i) / rate)
                      : Duration((times[i] - times[0]) / 1000);
    entries_.push_back({paths[i], time});
  }
}

std::optional<Duration> ImageSequence::NextTime() {
  if (next_ >= entries_.size()) return std::nullopt;
  return entries_[next_].time;
}

std::optional<cv::Mat> ImageSequence::Read(std::string* error) {
  const std::string& path = entries_[next_++].path;
  try {
    return LoadImageFile(path, ImageFileColor::kGrayOrBgr);
  } catch (const InputError& refusal) {
    *error = refusal.what();
    return std::nullopt;
  }
}

}  // namespace waymark
