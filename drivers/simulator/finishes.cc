#include "drivers/simulator/finishes.h"

#include "drivers/simulator/material_pattern.h"
#include "drivers/video/image_file.h"
#include "estimation/base/input_error.h"

#include <algorithm>
#include <stdexcept>

namespace waymark {
namespace {

struct BuiltIn {
  const char* name;
  PatternKind kind;
  std::optional<cv::Vec3b> color;  // BGR.
};

const std::vector<BuiltIn>& BuiltIns() {
  static const std::vector<BuiltIn> kAll{
      {"linoleum", PatternKind::kPlaster, cv::Vec3b(128, 140, 146)},
      {"ceiling", PatternKind::kPaint, cv::Vec3b(226, 230, 230)},
      {"skirting", PatternKind::kPaint, cv::Vec3b(96, 104, 110)},
      {"door_frame", PatternKind::kPaint, cv::Vec3b(112, 120, 126)},
      {"pillar", PatternKind::kPlaster, cv::Vec3b(206, 212, 214)},
      {"white", PatternKind::kPaint, cv::Vec3b(222, 226, 226)},
      {"metal", PatternKind::kPaint, cv::Vec3b(150, 148, 144)},
      {"dark", PatternKind::kPaint, cv::Vec3b(58, 54, 52)},
      {"wood", PatternKind::kPlanks, {}},
      {"carton", PatternKind::kPlaster, cv::Vec3b(98, 142, 178)},
  };
  return kAll;
}

cv::Mat3b ReadImage(const std::string& path, const std::string& where) {
  try {
    return LoadImageFile(path, ImageFileColor::kBgr);
  } catch (const InputError& error) {
    throw InputError(where + ": image: " + error.what());
  }
}

}  // namespace

std::optional<PatternOptions> BuiltInFinish(const std::string& name) {
  PatternOptions options;
  for (const BuiltIn& built_in : BuiltIns()) {
    if (name != built_in.name) continue;
    options.kind = built_in.kind;
    options.color = built_in.color;
    return options;
  }
  const std::optional<PatternKind> kind = PatternFromName(name);
  if (!kind) return std::nullopt;
  options.kind = *kind;
  return options;
}

std::vector<std::string> BuiltInFinishNames() {
  std::vector<std::string> names;
  for (const BuiltIn& built_in : BuiltIns()) names.emplace_back(built_in.name);
  for (const std::string& name : PatternNames()) names.push_back(name);
  return names;
}

Finish Finishes::Add(const std::string& name,
                     const cv::Mat3b& texture,
                     const Eigen::Vector2d& size,
                     bool is_one_piece) {
  Finish finish;
  finish.material = static_cast<std::uint32_t>(scene_->materials.size());
  finish.size = size;
  finish.is_one_piece = is_one_piece;
  scene_->materials.push_back({name, texture, false});
  return finish;
}

Finish Finishes::Make(const WorldLook& look,
                      const std::string& name,
                      const std::string& where) {
  if (is_plain_) return Plain(cv::Vec3b::all(160));
  if (!look.image.empty()) {
    return Add(name, ReadImage(look.image, where), look.image_size, false);
  }
  try {
    const PatternTexture texture = MakePattern(look.pattern);
    return Add(name, texture.image, texture.size, texture.is_one_piece);
  } catch (const std::invalid_argument& error) {
    throw InputError(where + ": " + error.what());
  }
}

WorldLook Finishes::LookOf(const std::string& name,
                           const std::string& where,
                           const std::string& key) const {
  const auto own = std::find_if(
      world_.materials.begin(),
      world_.materials.end(),
      [&](const WorldMaterial& material) { return material.name == name; });
  if (own != world_.materials.end()) return own->look;
  WorldLook look;
  if (const auto built_in = BuiltInFinish(name)) {
    look.pattern = *built_in;
    return look;
  }
  std::string known;
  for (const WorldMaterial& m : world_.materials) known += m.name + ", ";
  for (const std::string& b : BuiltInFinishNames()) known += b + ", ";
  known.resize(known.size() - 2);
  throw InputError(where + ": " + key + " = " + name +
                   ": must be one of: " + known);
}

Finish Finishes::Get(const std::string& name,
                     const std::string& where,
                     const std::string& key) {
  if (const auto found = made_.find(name); found != made_.end()) {
    return found->second;
  }
  const WorldLook look = LookOf(name, where, key);
  const auto own = std::find_if(
      world_.materials.begin(),
      world_.materials.end(),
      [&](const WorldMaterial& material) { return material.name == name; });
  return made_[name] = Make(
             look, name, own == world_.materials.end() ? where : own->where);
}

Finish Finishes::Plain(const cv::Vec3b& color) {
  // A name that no file can give.
  const std::string name = "\n" + std::to_string(color[0]) + "," +
                           std::to_string(color[1]) + "," +
                           std::to_string(color[2]);
  if (const auto found = made_.find(name); found != made_.end()) {
    return found->second;
  }
  return made_[name] = Add("plain", cv::Mat3b(1, 1, color), {1.0, 1.0}, false);
}

Finish Finishes::Lamp() {
  const std::string name = "\nlamp";
  if (const auto found = made_.find(name); found != made_.end()) {
    return found->second;
  }
  // Bright, but not burnt.
  const Finish finish =
      Add("lamp", cv::Mat3b(1, 1, cv::Vec3b(238, 246, 248)), {1.0, 1.0}, true);
  scene_->materials.back().is_emissive = true;
  return made_[name] = finish;
}

}  // namespace waymark
