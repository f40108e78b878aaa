// What the nodes of a glTF file share: buffers, accessors, images.
#pragma once

#include "drivers/simulator/gltf_document.h"
#include "drivers/simulator/mesh_source.h"

#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace waymark {

// Reads them at once, checked, written anew. Everything here throws InputError
// naming the file and the place in it.
class GltfData {
 public:
  using Json = GltfDocument::Json;

  // Keeps `document`.
  explicit GltfData(const GltfDocument& document);

  // An accessor of vertices, or of their indices; its place in the list.
  [[nodiscard]] std::int64_t AccessorOf(const Json& object,
                                        const std::string& key,
                                        const std::string& where,
                                        const std::string& type,
                                        bool is_index) const;
  [[nodiscard]] std::int64_t CountOf(std::int64_t accessor) const;
  // Refuses an accessor of indices with one that is too large.
  void CheckIndices(std::int64_t index,
                    std::int64_t num_vertices,
                    const std::string& where) const;

  // buffers, bufferViews, accessors, images and textures as a document.
  [[nodiscard]] const Json& clean() const { return clean_; }
  // The buffers' content, by name. None is left, nor can indices be checked.
  [[nodiscard]] std::map<std::string, std::string> TakeFiles() {
    return std::move(files_);
  }
  [[nodiscard]] std::vector<MeshSource::Image> TakeImages() {
    return std::move(images_);
  }

 private:
  void CleanBuffers();
  void CleanViews();
  void CleanAccessors();
  void CleanImages();
  void CleanTextures();

  const GltfDocument& document_;
  Json clean_ = Json::object();
  std::map<std::string, std::string> files_;
  std::vector<MeshSource::Image> images_;
};

}  // namespace waymark
