#include "drivers/simulator/gltf_data.h"
#include "drivers/simulator/gltf_document.h"
#include "drivers/simulator/mesh_file.h"
#include "drivers/simulator/mesh_source.h"

#include <cstdint>
#include <optional>
#include <utility>

namespace waymark {
namespace {

using Json = GltfDocument::Json;

constexpr int kMaxDepth = 64;  // Of nodes in nodes.
constexpr int kTriangles = 4;  // Mode of a primitive.

class GltfCleaner {
 public:
  explicit GltfCleaner(const std::string& path)
      : document_(path), data_(document_), out_(data_.clean()) {
    out_["asset"] = {{"version", "2.0"}};
  }

  MeshSource Clean() {
    CleanMaterials();
    CleanMeshes();
    CleanNodes();
    MeshSource source;
    source.main = "model.gltf";
    source.files = data_.TakeFiles();
    source.files["model.gltf"] = out_.dump();
    source.images = data_.TakeImages();
    source.has_linear_colors = true;
    return source;
  }

 private:
  // The texture under a key of a material, by its first coordinates.
  std::optional<Json> TextureOf(const Json& object,
                                const std::string& key,
                                const std::string& where) const {
    const Json* texture = GltfDocument::Child(object, key);
    if (texture == nullptr) return std::nullopt;
    if (document_.Whole(*texture, "texCoord", where + ", " + key, 0, 7, 0) !=
        0) {
      document_.Refuse(where + ": " + key +
                       " uses other than the first coordinates");
    }
    return Json{
        {"index",
         document_.Index(*texture, "index", where + ", " + key, "textures")}};
  }

  void CleanMaterials() {
    const Json& materials = document_.Items("materials");
    for (std::size_t i = 0; i < materials.size(); ++i) {
      const std::string where = GltfDocument::Entry("materials", i);
      const Json* extensions = GltfDocument::Child(materials[i], "extensions");
      const Json* gloss =
          extensions == nullptr
              ? nullptr
              : GltfDocument::Child(*extensions,
                                    "KHR_materials_pbrSpecularGlossiness");
      const Json* metal =
          GltfDocument::Child(materials[i], "pbrMetallicRoughness");
      std::optional<Json> texture;
      std::optional<Json> factor;
      if (gloss != nullptr) {
        texture = TextureOf(*gloss, "diffuseTexture", where);
        factor = document_.Numbers(*gloss, "diffuseFactor", where, 4, 0.0, 1.0);
      } else if (metal != nullptr) {
        texture = TextureOf(*metal, "baseColorTexture", where);
        factor =
            document_.Numbers(*metal, "baseColorFactor", where, 4, 0.0, 1.0);
      }
      // What only shines has its looks in what it gives off.
      if (!texture) {
        texture = TextureOf(materials[i], "emissiveTexture", where);
      }
      Json base = Json::object();
      if (texture) base["baseColorTexture"] = *texture;
      if (factor) base["baseColorFactor"] = *factor;
      const std::string name = GltfDocument::Text(materials[i], "name");
      out_["materials"].push_back({{"name", name.empty() ? where : name},
                                   {"pbrMetallicRoughness", std::move(base)}});
    }
  }

  Json CleanPrimitive(const Json& primitive, const std::string& where) {
    const Json* attributes = GltfDocument::Child(primitive, "attributes");
    if (attributes == nullptr) document_.Refuse(where + ": no attributes");
    const std::int64_t position =
        data_.AccessorOf(*attributes, "POSITION", where, "VEC3", false);
    Json out = {{"attributes", {{"POSITION", position}}}, {"mode", kTriangles}};
    std::int64_t num_corners = data_.CountOf(position);
    if (attributes->contains("TEXCOORD_0")) {
      const std::int64_t uv =
          data_.AccessorOf(*attributes, "TEXCOORD_0", where, "VEC2", false);
      if (data_.CountOf(uv) != data_.CountOf(position)) {
        document_.Refuse(where + ": not as many TEXCOORD_0 as POSITION");
      }
      out["attributes"]["TEXCOORD_0"] = uv;
    }
    if (primitive.contains("indices")) {
      const std::int64_t indices =
          data_.AccessorOf(primitive, "indices", where, "SCALAR", true);
      data_.CheckIndices(indices, data_.CountOf(position), where);
      num_corners = data_.CountOf(indices);
      out["indices"] = indices;
    }
    if (num_corners % 3 != 0) {
      document_.Refuse(where + ": " + std::to_string(num_corners) +
                       " corners are no whole number of triangles");
    }
    if (primitive.contains("material")) {
      out["material"] =
          document_.Index(primitive, "material", where, "materials");
    }
    num_triangles_.back() += num_corners / 3;
    return out;
  }

  void CleanMeshes() {
    const Json& meshes = document_.Items("meshes");
    for (std::size_t i = 0; i < meshes.size(); ++i) {
      const auto primitives = meshes[i].find("primitives");
      if (primitives == meshes[i].end() || !primitives->is_array()) {
        document_.Refuse(GltfDocument::Entry("meshes", i) + ": no primitives");
      }
      num_triangles_.push_back(0);
      Json kept = Json::array();
      for (std::size_t k = 0; k < primitives->size(); ++k) {
        const Json& primitive = (*primitives)[k];
        const std::string where = GltfDocument::Entry("meshes", i) + "." +
                                  GltfDocument::Entry("primitives", k);
        if (!primitive.is_object()) document_.Refuse(where + ": not an object");
        const std::int64_t mode =
            document_.Whole(primitive, "mode", where, 0, 6, kTriangles);
        if (mode < kTriangles) continue;  // Points and lines.
        if (mode > kTriangles) {
          document_.Refuse(where +
                           ": strips and fans of triangles are not read here");
        }
        kept.push_back(CleanPrimitive(primitive, where));
      }
      out_["meshes"].push_back({{"primitives", std::move(kept)}});
    }
  }

  // Copies the node and what hangs on it; returns its new index. Only what is
  // reached from the scene is kept, as often as it is reached.
  std::int64_t AddNode(std::int64_t index, int depth) {
    const Json& node =
        document_.Items("nodes")[static_cast<std::size_t>(index)];
    const std::string where =
        GltfDocument::Entry("nodes", static_cast<std::size_t>(index));
    if (depth > kMaxDepth) {
      document_.Refuse(where + ": more than " + std::to_string(kMaxDepth) +
                       " nodes in one another");
    }
    if (out_["nodes"].size() >=
        static_cast<std::size_t>(GltfDocument::kMaxItems)) {
      document_.Refuse("more than " + std::to_string(GltfDocument::kMaxItems) +
                       " nodes in the scene");
    }
    Json out = Json::object();
    // Bounds keep products of many within floats; those of a scene are tens.
    constexpr double kFar = 1e6;
    const auto take = [&](const char* key, std::size_t count, double bound) {
      if (const auto numbers =
              document_.Numbers(node, key, where, count, -bound, bound)) {
        out[key] = *numbers;
      }
    };
    take("matrix", 16, kFar);
    if (!out.contains("matrix")) {
      take("translation", 3, kFar);
      take("rotation", 4, 1.001);  // Unit quaternions, rounded.
      take("scale", 3, kFar);
    }
    const std::size_t place = out_["nodes"].size();
    out["name"] = "node" + std::to_string(place);
    if (node.contains("mesh")) {
      const std::int64_t mesh = document_.Index(node, "mesh", where, "meshes");
      total_ += num_triangles_[static_cast<std::size_t>(mesh)];
      if (total_ > kMaxMeshTriangles) {
        document_.Refuse("more than " + std::to_string(kMaxMeshTriangles) +
                         " triangles");
      }
      // A mesh without triangles is none for the library.
      if (num_triangles_[static_cast<std::size_t>(mesh)] > 0) {
        out["mesh"] = mesh;
      }
    }
    out_["nodes"].push_back(std::move(out));
    Json children = Json::array();
    for (const std::int64_t child : Indices(node, "children", where)) {
      children.push_back(AddNode(child, depth + 1));
    }
    if (!children.empty()) out_["nodes"][place]["children"] = children;
    return static_cast<std::int64_t>(place);
  }

  // Indices of nodes under a key.
  std::vector<std::int64_t> Indices(const Json& object,
                                    const std::string& key,
                                    const std::string& where) const {
    std::vector<std::int64_t> indices;
    const auto found = object.find(key);
    if (found == object.end()) return indices;
    const std::size_t count = document_.Items("nodes").size();
    if (!found->is_array())
      document_.Refuse(where + ": " + key + " is not an array");
    for (const Json& index : *found) {
      if (!index.is_number_unsigned() || index.get<std::uint64_t>() >= count) {
        document_.Refuse(std::string(where)
                             .append(": ")
                             .append(key)
                             .append(" has ")
                             .append(index.dump(-1, ' ', true))
                             .append(", but there are ")
                             .append(std::to_string(count))
                             .append(" nodes"));
      }
      indices.push_back(index.get<std::int64_t>());
    }
    return indices;
  }

  void CleanNodes() {
    out_["nodes"] = Json::array();
    const Json& scenes = document_.Items("scenes");
    if (scenes.empty()) document_.Refuse("no scenes");
    const std::int64_t scene =
        document_.Whole(document_.root(),
                        "scene",
                        "the file",
                        0,
                        static_cast<std::int64_t>(scenes.size()) - 1,
                        0);
    const std::string where =
        GltfDocument::Entry("scenes", static_cast<std::size_t>(scene));
    Json roots = Json::array();
    for (const std::int64_t node :
         Indices(scenes[static_cast<std::size_t>(scene)], "nodes", where)) {
      roots.push_back(AddNode(node, 0));
    }
    if (total_ == 0) document_.Refuse(where + ": no triangles");
    out_["scenes"] = Json::array({Json{{"nodes", roots}}});
    out_["scene"] = 0;
  }

  GltfDocument document_;
  GltfData data_;
  Json out_;
  std::vector<std::int64_t> num_triangles_;  // Of each mesh.
  std::int64_t total_ = 0;
};

}  // namespace

MeshSource ReadGltfSource(const std::string& path) {
  return GltfCleaner(path).Clean();
}

}  // namespace waymark
