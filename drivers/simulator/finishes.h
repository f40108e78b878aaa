// Materials of a scene by the names that a world gives them.
#pragma once

#include "drivers/simulator/mesh_builder.h"
#include "drivers/simulator/world.h"

#include <map>
#include <optional>
#include <string>
#include <vector>

namespace waymark {

// What is there without a definition in the file: every pattern by its name,
// and linoleum, ceiling, skirting, door_frame, pillar, metal, white, wood,
// fabric colours and the like.
[[nodiscard]] std::optional<PatternOptions> BuiltInFinish(
    const std::string& name);
[[nodiscard]] std::vector<std::string> BuiltInFinishNames();

// Makes each texture once, when it is first asked for.
class Finishes {
 public:
  // Plain: everything is one grey, nothing is drawn or read. World and scene
  // must outlive it.
  Finishes(const World& world, bool is_plain, Scene* scene)
      : world_(world), is_plain_(is_plain), scene_(scene) {}

  // Throws InputError naming `where` and `key` for a name unknown, and an image
  // that cannot be read.
  Finish Get(const std::string& name,
             const std::string& where,
             const std::string& key);
  // The look behind a name; throws as Get() does.
  [[nodiscard]] WorldLook LookOf(const std::string& name,
                                 const std::string& where,
                                 const std::string& key) const;
  // Of one object alone.
  Finish Make(const WorldLook& look,
              const std::string& name,
              const std::string& where);
  // One flat colour, BGR.
  Finish Plain(const cv::Vec3b& color);
  // Shines by itself.
  Finish Lamp();

 private:
  Finish Add(const std::string& name,
             const cv::Mat3b& texture,
             const Eigen::Vector2d& size,
             bool is_one_piece);

  const World& world_;
  bool is_plain_;
  Scene* scene_;
  std::map<std::string, Finish> made_;
};

}  // namespace waymark
