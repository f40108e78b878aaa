#include "drivers/simulator/mesh_file.h"
#include "drivers/simulator/mesh_source.h"
#include "estimation/base/input_error.h"
#include "estimation/base/whole_file.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <utility>

namespace waymark {
namespace {

constexpr std::string_view kBlanks = " \t\r";
constexpr int kMaxFaceCorners = 1000;

std::string_view Trimmed(std::string_view text) {
  const std::size_t first = text.find_first_not_of(kBlanks);
  if (first == std::string_view::npos) return {};
  const std::size_t last = text.find_last_not_of(kBlanks);
  return text.substr(first, last - first + 1);
}

// Takes the first word off.
std::string_view NextWord(std::string_view* text) {
  *text = Trimmed(*text);
  const std::string_view word = text->substr(0, text->find_first_of(kBlanks));
  text->remove_prefix(word.size());
  return word;
}

std::optional<double> Number(std::string_view word) {
  if (word.starts_with('+')) word.remove_prefix(1);
  double value = 0.0;
  const auto [end, error] =
      std::from_chars(word.data(), word.data() + word.size(), value);
  // Floats follow: their range is that of what can be meant.
  if (error != std::errc() || end != word.data() + word.size() ||
      !(std::abs(value) < 1e30)) {
    return std::nullopt;
  }
  return value;
}

void AppendNumber(double value, std::string* text) {
  std::array<char, 40> buffer{};
  const auto [end, error] = std::to_chars(
      buffer.data(), buffer.data() + buffer.size(), static_cast<float>(value));
  *text += ' ';
  text->append(buffer.data(), end);
}

// Materials and names are called by number in the cleaned files, so that
// nothing in a name matters.
class ObjCleaner {
 public:
  explicit ObjCleaner(const std::string& path) : path_(path) {}

  MeshSource Clean() {
    source_.main = "model.obj";
    AddLines(path_, &ObjCleaner::AddModelLine);
    if (num_faces_ == 0) throw InputError(path_ + ": no faces");
    // Every corner has a texture coordinate; that of those without is the
    // first.
    std::string head = "vt 0 0\n";
    if (!names_.empty()) {
      head += "mtllib model.mtl\n";
      source_.files["model.mtl"] = std::move(materials_);
    }
    source_.files["model.obj"] = head + model_;
    return std::move(source_);
  }

 private:
  using LineHandler = void (ObjCleaner::*)(std::string_view keyword,
                                           std::string_view rest);

  [[noreturn]] void Refuse(const std::string& what) const {
    throw InputError(file_ + ", line " + std::to_string(line_) + ": " + what);
  }

  [[nodiscard]] std::string TextOf(const std::string& path) const {
    try {
      return ReadWholeFile(path, kMaxMeshFileBytes);
    } catch (const InputError& error) {
      if (file_.empty()) throw;
      Refuse(error.what());
    }
  }

  // Calls `handle` for each line that is not empty or a comment.
  void AddLines(const std::string& path, LineHandler handle) {
    const std::string text = TextOf(path);
    const std::string outer_file = std::exchange(file_, path);
    const int outer_line = std::exchange(line_, 0);
    std::size_t begin = 0;
    std::string joined;
    while (begin < text.size()) {
      const std::size_t end = std::min(text.find('\n', begin), text.size());
      std::string_view line =
          Trimmed(std::string_view(text).substr(begin, end - begin));
      begin = end + 1;
      ++line_;
      if (line.ends_with('\\')) {  // Goes on in the next one.
        line.remove_suffix(1);
        joined.append(line).append(" ");
        continue;
      }
      joined += line;
      std::string_view rest = joined;
      const std::string_view keyword = NextWord(&rest);
      if (!keyword.empty() && !keyword.starts_with('#')) {
        (this->*handle)(keyword, Trimmed(rest));
      }
      joined.clear();
    }
    file_ = outer_file;
    line_ = outer_line;
  }

  void AddModelLine(std::string_view keyword, std::string_view rest) {
    if (keyword == "v") {
      AddNumbers("v", 3, 3, rest);
      ++num_positions_;
    } else if (keyword == "vt") {
      AddNumbers("vt", 1, 2, rest);
      ++num_uvs_;
    } else if (keyword == "f") {
      AddFace(rest);
    } else if (keyword == "usemtl") {
      const auto found = names_.find(std::string(rest));
      if (found == names_.end()) {
        Refuse("no material library has '" + std::string(rest) + "'");
      }
      model_ += "usemtl m" + std::to_string(found->second) + '\n';
    } else if (keyword == "mtllib") {
      const std::filesystem::path folder =
          std::filesystem::path(path_).parent_path();
      AddLines((folder / FileName(rest)).string(),
               &ObjCleaner::AddMaterialLine);
    }
    // Groups, normals, smoothing, lines, points, curves are not drawn.
  }

  void AddMaterialLine(std::string_view keyword, std::string_view rest) {
    if (keyword == "newmtl") {
      const std::size_t index = names_.size();
      if (!names_.emplace(std::string(rest), index).second) {
        Refuse("material '" + std::string(rest) + "' is there twice");
      }
      materials_ += "newmtl m" + std::to_string(index) + '\n';
      return;
    }
    if (keyword != "Kd" && keyword != "map_Kd") return;
    if (names_.empty()) Refuse(std::string(keyword) + " before any newmtl");
    if (keyword == "Kd") {
      materials_ += "Kd";
      for (int i = 0; i < 3; ++i) {
        const std::optional<double> value = Number(NextWord(&rest));
        if (!value || *value < 0.0 || *value > 1.0) {
          Refuse("Kd needs three numbers in [0, 1]");
        }
        AppendNumber(*value, &materials_);
      }
      materials_ += '\n';
      return;
    }
    if (rest.empty() || rest.starts_with('-')) {
      Refuse("map_Kd takes a file and no options");
    }
    materials_ += "map_Kd " + MeshImageName(source_.images.size()) + '\n';
    const std::filesystem::path folder =
        std::filesystem::path(file_).parent_path();
    const std::string image = FileName(rest);
    source_.images.push_back({image, (folder / image).string(), {}});
  }

  static std::string FileName(std::string_view text) {
    std::string name(text);
    std::replace(name.begin(), name.end(), '\\', '/');
    return name;
  }

  void AddNumbers(std::string_view keyword,
                  int needed,
                  int written,
                  std::string_view rest) {
    model_ += keyword;
    for (int i = 0; i < written; ++i) {
      const std::string_view word = NextWord(&rest);
      std::optional<double> value = Number(word);
      if (i >= needed && word.empty()) value = 0.0;
      if (!value) {
        Refuse(std::string(keyword) + ": '" + std::string(word) +
               "' is not a number");
      }
      AppendNumber(*value, &model_);
    }
    model_ += '\n';
  }

  // An index counts from 1, or back from the end.
  std::int64_t Index(std::string_view word, std::int64_t count) const {
    std::int64_t value = 0;
    const auto [end, error] =
        std::from_chars(word.data(), word.data() + word.size(), value);
    const std::int64_t index = value < 0 ? count + value + 1 : value;
    if (error != std::errc() || end != word.data() + word.size() || index < 1 ||
        index > count) {
      Refuse("f: '" + std::string(word) + "' is not one of the " +
             std::to_string(count) + " vertices so far");
    }
    return index;
  }

  void AddFace(std::string_view rest) {
    std::vector<std::array<std::int64_t, 2>> corners;
    for (std::string_view word = NextWord(&rest); !word.empty();
         word = NextWord(&rest)) {
      const std::size_t slash = word.find('/');
      std::string_view uv;
      if (slash != std::string_view::npos) {
        uv = word.substr(slash + 1);
        uv = uv.substr(0, uv.find('/'));
      }
      corners.push_back({Index(word.substr(0, slash), num_positions_),
                         uv.empty() ? 0 : Index(uv, num_uvs_)});
    }
    if (corners.size() < 3 || corners.size() > kMaxFaceCorners) {
      Refuse("f: " + std::to_string(corners.size()) + " corners, not in [3, " +
             std::to_string(kMaxFaceCorners) + "]");
    }
    num_faces_ += static_cast<std::int64_t>(corners.size()) - 2;
    if (num_faces_ > kMaxMeshTriangles) {
      Refuse("more than " + std::to_string(kMaxMeshTriangles) + " triangles");
    }
    model_ += 'f';
    for (const auto& [position, uv] : corners) {
      model_ += ' ' + std::to_string(position) + '/' + std::to_string(uv + 1);
    }
    model_ += '\n';
  }

  std::string path_;
  std::string file_;  // Being read.
  int line_ = 0;
  std::string model_;
  std::string materials_;
  std::map<std::string, std::size_t> names_;  // Of materials.
  std::int64_t num_positions_ = 0;
  std::int64_t num_uvs_ = 0;
  std::int64_t num_faces_ = 0;
  MeshSource source_;
};

}  // namespace

std::string MeshImageName(std::size_t index) {
  return "image" + std::to_string(index);
}

MeshSource ReadObjSource(const std::string& path) {
  return ObjCleaner(path).Clean();
}

}  // namespace waymark
