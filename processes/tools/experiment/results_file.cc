#include "processes/tools/experiment/results_file.h"

#include "estimation/base/input_error.h"
#include "processes/support/state_file.h"

#include <fcntl.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <sstream>
#include <system_error>

namespace waymark {
namespace {

using json = nlohmann::ordered_json;

std::string TextOfFile(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

// The first line in which the two texts differ.
std::string Difference(const std::string& was, const std::string& is) {
  std::istringstream a(was);
  std::istringstream b(is);
  std::string line_a;
  std::string line_b;
  for (;;) {
    const bool has_a = static_cast<bool>(std::getline(a, line_a));
    const bool has_b = static_cast<bool>(std::getline(b, line_b));
    if (!has_a && !has_b) return "";
    if (!has_a) line_a = "nothing";
    if (!has_b) line_b = "nothing";
    if (line_a != line_b) {
      return "'" + line_a + "' there, '" + line_b + "' here";
    }
  }
}

}  // namespace

std::string LineOfResult(const RunResult& result) {
  json figures = json::object();
  for (const auto& [name, value] : result.figures) figures[name] = value;
  const json line{{"seed", result.seed},
                  {"success", result.is_success},
                  {"reason", result.reason},
                  {"touches", result.num_touches},
                  {"way_m", result.way_m},
                  {"shortest_m", result.shortest_m},
                  {"duration_s", result.duration_s},
                  {"figures", figures}};
  return line.dump();
}

RunResult ResultOfLine(const std::string& line) {
  try {
    const json object = json::parse(line);
    RunResult result;
    result.seed = object.at("seed").get<std::uint64_t>();
    result.is_success = object.at("success").get<bool>();
    result.reason = object.at("reason").get<std::string>();
    result.num_touches = object.at("touches").get<std::int64_t>();
    result.way_m = object.at("way_m").get<double>();
    result.shortest_m = object.at("shortest_m").get<double>();
    result.duration_s = object.at("duration_s").get<double>();
    for (const auto& [name, value] : object.at("figures").items()) {
      result.figures.emplace_back(name, value.get<double>());
    }
    return result;
  } catch (const json::exception& error) {
    throw InputError(std::string("no result of a run: ") + error.what());
  }
}

ResultsFile::ResultsFile(const std::string& path,
                         const std::string& experiment,
                         const std::string& configuration)
    : path_(path),
      header_(json{{"experiment", experiment}, {"configuration", configuration}}
                  .dump()) {
  const std::string text = TextOfFile(path);
  // What a kill tore off while it was written has no end of line.
  const std::size_t whole = text.rfind('\n') + 1;  // 0 where there is none.
  Read(text.substr(0, whole));
  fd_ = open(path.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0644);
  if (fd_ < 0 || ftruncate(fd_, static_cast<off_t>(whole)) != 0) {
    throw InputError(path + ": " + std::strerror(errno));
  }
  if (whole == 0 &&
      write(fd_, (header_ + "\n").c_str(), header_.size() + 1) < 0) {
    throw InputError(path + ": " + std::strerror(errno));
  }
}

ResultsFile::~ResultsFile() {
  if (fd_ >= 0) close(fd_);
}

void ResultsFile::Read(const std::string& text) {
  std::istringstream lines(text);
  std::string line;
  for (int number = 1; std::getline(lines, line); ++number) {
    const std::string where = path_ + ":" + std::to_string(number) + ": ";
    try {
      if (number > 1) {
        const RunResult result = ResultOfLine(line);
        results_[result.seed] = result;
        continue;
      }
      const json was = json::parse(line);
      const json is = json::parse(header_);
      for (const char* key : {"experiment", "configuration"}) {
        const std::string difference = Difference(was.at(key), is.at(key));
        if (difference.empty()) continue;
        throw InputError("results of another " + std::string(key) + ": " +
                         difference + "; choose another --out");
      }
    } catch (const json::exception&) {
      throw InputError(where + "no results of an experiment");
    } catch (const InputError& error) {
      throw InputError(where + error.what());
    }
  }
}

void ResultsFile::Add(const RunResult& result) {
  results_[result.seed] = result;
  const std::string line = LineOfResult(result) + "\n";
  // One call: a line is there as a whole or, torn by a full disk, without end.
  const ssize_t written = write(fd_, line.data(), line.size());
  if (written != static_cast<ssize_t>(line.size()) || fdatasync(fd_) != 0) {
    throw InputError(path_ + ": " +
                     (written < 0 ? std::strerror(errno) : "disk is full"));
  }
}

void ResultsFile::Sort() const {
  std::string text = header_ + "\n";
  for (const auto& [seed, result] : results_) {
    text += LineOfResult(result) + "\n";
  }
  SaveStateFile(path_, text);
}

}  // namespace waymark
