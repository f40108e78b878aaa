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
constexpr int kUnsignedByte = 5121;
constexpr int kUnsignedShort = 5123;
constexpr int kUnsignedInt = 5125;
constexpr int kFloat = 5126;

class GltfCleaner {
 public:
  explicit GltfCleaner(const std::string& path) : document_(path) {}

  MeshSource Clean() {
    CheckHead();
    CleanBuffers();
    CleanAccessors();
    CleanImages();
    CleanMaterials();
    CleanMeshes();
    CleanNodes();
    source_.main = "model.gltf";
    source_.files["model.gltf"] = out_.dump();
    source_.has_linear_colors = true;
    return std::move(source_);
  }

 private:
  void CheckHead() {
    const Json* asset = GltfDocument::Child(document_.root(), "asset");
    if (asset == nullptr ||
        !GltfDocument::Text(*asset, "version").starts_with("2.")) {
      document_.Refuse("asset: version must be 2.x");
    }
    out_["asset"] = {{"version", "2.0"}};
    const auto required = document_.root().find("extensionsRequired");
    if (required == document_.root().end()) return;
    if (!required->is_array())
      document_.Refuse("extensionsRequired: not an array");
    for (const Json& name : *required) {
      if (!name.is_string() ||
          !name.get<std::string>().starts_with("KHR_materials_")) {
        document_.Refuse("needs the extension " + name.dump(-1, ' ', true) +
                         ", which is not read here (KHR_materials_* are)");
      }
    }
  }

  void CleanBuffers() {
    const Json& buffers = document_.Items("buffers");
    for (std::size_t i = 0; i < buffers.size(); ++i) {
      const std::string where = GltfDocument::Entry("buffers", i);
      const std::int64_t length =
          document_.Whole(buffers[i],
                          "byteLength",
                          where,
                          1,
                          static_cast<std::int64_t>(kMaxMeshFileBytes));
      const std::string uri = GltfDocument::Text(buffers[i], "uri");
      std::string bytes =
          uri.empty() ? document_.binary() : document_.Resolve(uri, where);
      if (static_cast<std::int64_t>(bytes.size()) < length) {
        document_.Refuse(where + ": byteLength is " + std::to_string(length) +
                         ", but " + std::to_string(bytes.size()) +
                         " bytes are there");
      }
      bytes.resize(static_cast<std::size_t>(length));
      const std::string name = "buffer" + std::to_string(i) + ".bin";
      source_.files[name] = std::move(bytes);
      out_["buffers"].push_back({{"byteLength", length}, {"uri", name}});
    }
    const Json& views = document_.Items("bufferViews");
    for (std::size_t i = 0; i < views.size(); ++i) {
      const std::string where = GltfDocument::Entry("bufferViews", i);
      const std::int64_t buffer =
          document_.Index(views[i], "buffer", where, "buffers");
      const std::int64_t size =
          out_["buffers"][static_cast<std::size_t>(buffer)]["byteLength"];
      const std::int64_t offset =
          document_.Whole(views[i], "byteOffset", where, 0, size, 0);
      const std::int64_t length =
          document_.Whole(views[i], "byteLength", where, 1, size - offset);
      const std::int64_t stride =
          document_.Whole(views[i], "byteStride", where, 0, 252, 0);
      Json view = {
          {"buffer", buffer}, {"byteOffset", offset}, {"byteLength", length}};
      if (stride > 0) view["byteStride"] = stride;
      out_["bufferViews"].push_back(std::move(view));
    }
  }

  void CleanAccessors() {
    static const std::map<std::string, std::int64_t> kComponents{{"SCALAR", 1},
                                                                 {"VEC2", 2},
                                                                 {"VEC3", 3},
                                                                 {"VEC4", 4},
                                                                 {"MAT2", 4},
                                                                 {"MAT3", 9},
                                                                 {"MAT4", 16}};
    const Json& accessors = document_.Items("accessors");
    for (std::size_t i = 0; i < accessors.size(); ++i) {
      const Json& accessor = accessors[i];
      const std::string where = GltfDocument::Entry("accessors", i);
      if (accessor.contains("sparse")) {
        document_.Refuse(where + ": sparse accessors are not read here");
      }
      const std::int64_t view =
          document_.Index(accessor, "bufferView", where, "bufferViews");
      const Json& out_view =
          out_["bufferViews"][static_cast<std::size_t>(view)];
      const std::int64_t room = out_view["byteLength"];
      const std::string type = GltfDocument::Text(accessor, "type");
      const auto components = kComponents.find(type);
      if (components == kComponents.end())
        document_.Refuse(where + ": unknown type");
      const std::int64_t component =
          document_.Whole(accessor, "componentType", where, 5120, kFloat);
      const std::int64_t element =
          components->second * (component >= kUnsignedInt        ? 4
                                : component >= kUnsignedByte + 1 ? 2
                                                                 : 1);
      const std::int64_t stride = out_view.value("byteStride", element);
      if (stride < element)
        document_.Refuse(where + ": longer than its view's stride");
      const std::int64_t offset =
          document_.Whole(accessor, "byteOffset", where, 0, room, 0);
      const std::int64_t count = document_.Whole(
          accessor, "count", where, 1, 3 * std::int64_t{kMaxMeshTriangles});
      if (offset + stride * (count - 1) + element > room) {
        document_.Refuse(where + ": its " + std::to_string(count) +
                         " elements do not fit into bufferViews[" +
                         std::to_string(view) + "]");
      }
      out_["accessors"].push_back({{"bufferView", view},
                                   {"byteOffset", offset},
                                   {"componentType", component},
                                   {"count", count},
                                   {"type", type}});
    }
  }

  void CleanImages() {
    const Json& images = document_.Items("images");
    for (std::size_t i = 0; i < images.size(); ++i) {
      const std::string where = GltfDocument::Entry("images", i);
      const std::string uri = GltfDocument::Text(images[i], "uri");
      MeshSource::Image image;
      image.name = where;
      if (uri.empty()) {
        const std::int64_t index =
            document_.Index(images[i], "bufferView", where, "bufferViews");
        const Json& view = out_["bufferViews"][static_cast<std::size_t>(index)];
        image.bytes =
            source_.files
                .at("buffer" +
                    std::to_string(view["buffer"].get<std::int64_t>()) + ".bin")
                .substr(view["byteOffset"].get<std::size_t>(),
                        view["byteLength"].get<std::size_t>());
      } else if (uri.starts_with("data:")) {
        image.bytes = document_.Resolve(uri, where);
      } else {
        image.name = uri;
        image.path = document_.FilePath(uri);
      }
      source_.images.push_back(std::move(image));
      out_["images"].push_back({{"uri", MeshImageName(i)}});
    }
    const Json& textures = document_.Items("textures");
    for (std::size_t i = 0; i < textures.size(); ++i) {
      out_["textures"].push_back(
          {{"source",
            document_.Index(textures[i],
                            "source",
                            GltfDocument::Entry("textures", i),
                            "images")}});
    }
  }

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

  // An accessor of vertices, or of their indices.
  std::int64_t AccessorOf(const Json& object,
                          const std::string& key,
                          const std::string& where,
                          const std::string& type,
                          bool is_index) const {
    const std::int64_t index = document_.Index(object, key, where, "accessors");
    const Json& accessor = out_["accessors"][static_cast<std::size_t>(index)];
    const std::int64_t component = accessor["componentType"];
    const bool fits = is_index ? component == kUnsignedByte ||
                                     component == kUnsignedShort ||
                                     component == kUnsignedInt
                               : component == kFloat;
    if (!fits || accessor["type"] != type) {
      document_.Refuse(where + ": " + key + " must be " + type + " of " +
                       (is_index ? "unsigned numbers" : "floats"));
    }
    return index;
  }

  std::int64_t CountOf(std::int64_t accessor) const {
    return out_["accessors"][static_cast<std::size_t>(accessor)]["count"];
  }

  void CheckIndices(std::int64_t index,
                    std::int64_t num_vertices,
                    const std::string& where) const {
    const Json& accessor = out_["accessors"][static_cast<std::size_t>(index)];
    const Json& view =
        out_["bufferViews"][accessor["bufferView"].get<std::size_t>()];
    const std::string& bytes = source_.files.at(
        "buffer" + std::to_string(view["buffer"].get<std::int64_t>()) + ".bin");
    const std::int64_t component = accessor["componentType"];
    const std::size_t size = component == kUnsignedInt     ? 4
                             : component == kUnsignedShort ? 2
                                                           : 1;
    const std::size_t stride = view.value("byteStride", size);
    const std::size_t start = view["byteOffset"].get<std::size_t>() +
                              accessor["byteOffset"].get<std::size_t>();
    const std::size_t count = accessor["count"];
    for (std::size_t i = 0; i < count; ++i) {
      std::int64_t value = 0;
      for (std::size_t k = size; k-- > 0;) {
        value = 256 * value +
                static_cast<std::uint8_t>(bytes[start + i * stride + k]);
      }
      if (value >= num_vertices) {
        document_.Refuse(where + ": index " + std::to_string(value) +
                         ", but there are " + std::to_string(num_vertices) +
                         " vertices");
      }
    }
  }

  Json CleanPrimitive(const Json& primitive, const std::string& where) {
    const Json* attributes = GltfDocument::Child(primitive, "attributes");
    if (attributes == nullptr) document_.Refuse(where + ": no attributes");
    const std::int64_t position =
        AccessorOf(*attributes, "POSITION", where, "VEC3", false);
    Json out = {{"attributes", {{"POSITION", position}}}, {"mode", kTriangles}};
    std::int64_t num_corners = CountOf(position);
    if (attributes->contains("TEXCOORD_0")) {
      const std::int64_t uv =
          AccessorOf(*attributes, "TEXCOORD_0", where, "VEC2", false);
      if (CountOf(uv) != CountOf(position)) {
        document_.Refuse(where + ": not as many TEXCOORD_0 as POSITION");
      }
      out["attributes"]["TEXCOORD_0"] = uv;
    }
    if (primitive.contains("indices")) {
      const std::int64_t indices =
          AccessorOf(primitive, "indices", where, "SCALAR", true);
      CheckIndices(indices, CountOf(position), where);
      num_corners = CountOf(indices);
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
        document_.Refuse(where + ": " + key + " has " +
                         index.dump(-1, ' ', true) + ", but there are " +
                         std::to_string(count) + " nodes");
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
  Json out_;
  std::vector<std::int64_t> num_triangles_;  // Of each mesh.
  std::int64_t total_ = 0;
  MeshSource source_;
};

}  // namespace

MeshSource ReadGltfSource(const std::string& path) {
  return GltfCleaner(path).Clean();
}

}  // namespace waymark
