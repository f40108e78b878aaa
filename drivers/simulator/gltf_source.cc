#include "drivers/simulator/image_file.h"
#include "drivers/simulator/mesh_file.h"
#include "drivers/simulator/mesh_source.h"
#include "estimation/base/input_error.h"

#include <nlohmann/json.hpp>

#include <cmath>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <utility>

namespace waymark {
namespace {

using Json = nlohmann::json;

constexpr std::int64_t kMaxItems = 100'000;  // Of each kind.
constexpr int kMaxDepth = 64;                // Of nodes in nodes.
constexpr int kTriangles = 4;                // Mode of a primitive.
constexpr int kUnsignedByte = 5121;
constexpr int kUnsignedShort = 5123;
constexpr int kUnsignedInt = 5125;
constexpr int kFloat = 5126;

// Four bytes, least first.
std::uint32_t Word(const std::string& bytes, std::size_t at) {
  std::uint32_t value = 0;
  for (std::size_t i = 4; i-- > 0;) {
    value = (value << 8U) | static_cast<std::uint8_t>(bytes[at + i]);
  }
  return value;
}

// Decodes base64; nullopt where it is none.
std::optional<std::string> FromBase64(std::string_view text) {
  while (text.ends_with('=')) text.remove_suffix(1);
  std::string bytes;
  std::uint32_t bits = 0;
  int num_bits = 0;
  for (const char c : text) {
    constexpr std::string_view kDigits =
        "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    const std::size_t digit = kDigits.find(c);
    if (digit == std::string_view::npos) return std::nullopt;
    bits = (bits << 6U) | static_cast<std::uint32_t>(digit);
    num_bits += 6;
    if (num_bits >= 8) {
      num_bits -= 8;
      bytes +=
          static_cast<char>((bits >> static_cast<unsigned>(num_bits)) & 0xFFU);
    }
  }
  return bytes;
}

// "a%20b" is "a b".
std::string FromPercent(std::string_view text) {
  const auto digit = [](char c) {
    constexpr std::string_view kDigits = "0123456789abcdef";
    return kDigits.find(c >= 'A' && c <= 'F' ? static_cast<char>(c + 32) : c);
  };
  std::string plain;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '%' && i + 2 < text.size() &&
        digit(text[i + 1]) != std::string_view::npos &&
        digit(text[i + 2]) != std::string_view::npos) {
      plain += static_cast<char>(16 * digit(text[i + 1]) + digit(text[i + 2]));
      i += 2;
    } else {
      plain += text[i];
    }
  }
  return plain;
}

class GltfCleaner {
 public:
  explicit GltfCleaner(const std::string& path) : path_(path) {}

  MeshSource Clean() {
    ReadDocument();
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
  [[noreturn]] void Refuse(const std::string& what) const {
    throw InputError(path_ + ": " + what);
  }

  // ---- reading values ------------------------------------------------------

  // The array under a key of the document, of objects; empty where missing.
  const Json& Items(const std::string& key) const {
    static const Json kNone = Json::array();
    const auto found = document_.find(key);
    if (found == document_.end()) return kNone;
    if (!found->is_array() ||
        found->size() > static_cast<std::size_t>(kMaxItems)) {
      Refuse(key + ": not an array of at most " + std::to_string(kMaxItems));
    }
    for (const Json& item : *found) {
      if (!item.is_object()) Refuse(key + ": an entry is not an object");
    }
    return *found;
  }

  // Whole number in [low, high]; `otherwise` where the key is missing.
  std::int64_t Whole(const Json& object,
                     const std::string& key,
                     const std::string& where,
                     std::int64_t low,
                     std::int64_t high,
                     std::optional<std::int64_t> otherwise = {}) const {
    const auto found = object.find(key);
    if (found == object.end() && otherwise) return *otherwise;
    if (found == object.end() || !found->is_number_integer() ||
        (found->is_number_unsigned() &&
         found->get<std::uint64_t>() > static_cast<std::uint64_t>(INT64_MAX)) ||
        found->get<std::int64_t>() < low || found->get<std::int64_t>() > high) {
      Refuse(where + ": " + key + " must be a whole number in [" +
             std::to_string(low) + ", " + std::to_string(high) + "]");
    }
    return found->get<std::int64_t>();
  }

  std::int64_t Index(const Json& object,
                     const std::string& key,
                     const std::string& where,
                     const std::string& list) const {
    const std::size_t count = Items(list).size();
    if (count == 0) Refuse(where + ": " + key + ", but there are no " + list);
    return Whole(object, key, where, 0, static_cast<std::int64_t>(count) - 1);
  }

  // `count` finite numbers, where the key is there.
  std::optional<Json> Numbers(const Json& object,
                              const std::string& key,
                              const std::string& where,
                              std::size_t count,
                              double low,
                              double high) const {
    const auto found = object.find(key);
    if (found == object.end()) return std::nullopt;
    bool is_sound = found->is_array() && found->size() == count;
    for (std::size_t i = 0; is_sound && i < count; ++i) {
      is_sound = (*found)[i].is_number() && (*found)[i].get<double>() >= low &&
                 (*found)[i].get<double>() <= high;
    }
    if (!is_sound) {
      Refuse(where + ": " + key + " must be " + std::to_string(count) +
             " numbers in [" + std::to_string(low) + ", " +
             std::to_string(high) + "]");
    }
    return *found;
  }

  static const Json* Child(const Json& object, const std::string& key) {
    const auto found = object.find(key);
    return found != object.end() && found->is_object() ? &*found : nullptr;
  }

  static std::string Text(const Json& object, const std::string& key) {
    const auto found = object.find(key);
    return found != object.end() && found->is_string()
               ? found->get<std::string>()
               : std::string();
  }

  static std::string Entry(const std::string& list, std::size_t i) {
    return list + "[" + std::to_string(i) + "]";
  }

  // ---- the parts -----------------------------------------------------------

  void ReadDocument() {
    const std::string bytes = ReadWholeFile(path_, kMaxMeshFileBytes);
    std::string text = bytes;
    if (bytes.starts_with("glTF")) {
      // Header of three words, then chunks: length, type, content.
      constexpr std::uint32_t kJsonChunk = 0x4E4F534Au;
      constexpr std::uint32_t kBinaryChunk = 0x004E4942u;
      const auto chunk = [&](std::size_t at, std::uint32_t type) {
        if (at + 8 > bytes.size() || Word(bytes, at + 4) != type ||
            Word(bytes, at) > bytes.size() - at - 8) {
          Refuse("a chunk of the binary glTF is missing or cut off");
        }
        return bytes.substr(at + 8, Word(bytes, at));
      };
      if (bytes.size() < 12 || Word(bytes, 4) != 2) {
        Refuse("binary glTF of another version than 2");
      }
      text = chunk(12, kJsonChunk);
      const std::size_t next = 20 + text.size();
      if (next < bytes.size()) binary_ = chunk(next, kBinaryChunk);
    }
    try {
      document_ = Json::parse(text);
    } catch (const Json::parse_error& error) {
      Refuse("not JSON at byte " + std::to_string(error.byte));
    } catch (const Json::exception&) {  // A number beyond a double.
      Refuse("not JSON: a number out of range");
    }
    if (!document_.is_object()) Refuse("not a glTF file: no object");
  }

  void CheckHead() {
    const Json* asset = Child(document_, "asset");
    if (asset == nullptr || !Text(*asset, "version").starts_with("2.")) {
      Refuse("asset: version must be 2.x");
    }
    out_["asset"] = {{"version", "2.0"}};
    const auto required = document_.find("extensionsRequired");
    if (required == document_.end()) return;
    if (!required->is_array()) Refuse("extensionsRequired: not an array");
    for (const Json& name : *required) {
      if (!name.is_string() ||
          !name.get<std::string>().starts_with("KHR_materials_")) {
        Refuse("needs the extension " + name.dump(-1, ' ', true) +
               ", which is not read here (KHR_materials_* are)");
      }
    }
  }

  // What an uri says, or the content of a data: uri.
  std::string Resolve(const std::string& uri, const std::string& where) const {
    if (uri.starts_with("data:")) {
      const std::size_t comma = uri.find(";base64,");
      const std::optional<std::string> bytes =
          comma == std::string::npos
              ? std::nullopt
              : FromBase64(std::string_view(uri).substr(comma + 8));
      if (!bytes) Refuse(where + ": its data uri is not base64");
      return *bytes;
    }
    try {
      return ReadWholeFile(FilePath(uri), kMaxMeshFileBytes);
    } catch (const InputError& error) {
      Refuse(where + ": " + error.what());
    }
  }

  [[nodiscard]] std::string FilePath(const std::string& uri) const {
    const std::filesystem::path folder =
        std::filesystem::path(path_).parent_path();
    return (folder / FromPercent(uri)).string();
  }

  void CleanBuffers() {
    const Json& buffers = Items("buffers");
    for (std::size_t i = 0; i < buffers.size(); ++i) {
      const std::string where = Entry("buffers", i);
      const std::int64_t length =
          Whole(buffers[i],
                "byteLength",
                where,
                1,
                static_cast<std::int64_t>(kMaxMeshFileBytes));
      const std::string uri = Text(buffers[i], "uri");
      std::string bytes = uri.empty() ? binary_ : Resolve(uri, where);
      if (static_cast<std::int64_t>(bytes.size()) < length) {
        Refuse(where + ": byteLength is " + std::to_string(length) + ", but " +
               std::to_string(bytes.size()) + " bytes are there");
      }
      bytes.resize(static_cast<std::size_t>(length));
      const std::string name = "buffer" + std::to_string(i) + ".bin";
      source_.files[name] = std::move(bytes);
      out_["buffers"].push_back({{"byteLength", length}, {"uri", name}});
    }
    const Json& views = Items("bufferViews");
    for (std::size_t i = 0; i < views.size(); ++i) {
      const std::string where = Entry("bufferViews", i);
      const std::int64_t buffer = Index(views[i], "buffer", where, "buffers");
      const std::int64_t size =
          out_["buffers"][static_cast<std::size_t>(buffer)]["byteLength"];
      const std::int64_t offset =
          Whole(views[i], "byteOffset", where, 0, size, 0);
      const std::int64_t length =
          Whole(views[i], "byteLength", where, 1, size - offset);
      const std::int64_t stride =
          Whole(views[i], "byteStride", where, 0, 252, 0);
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
    const Json& accessors = Items("accessors");
    for (std::size_t i = 0; i < accessors.size(); ++i) {
      const Json& accessor = accessors[i];
      const std::string where = Entry("accessors", i);
      if (accessor.contains("sparse")) {
        Refuse(where + ": sparse accessors are not read here");
      }
      const std::int64_t view =
          Index(accessor, "bufferView", where, "bufferViews");
      const Json& out_view =
          out_["bufferViews"][static_cast<std::size_t>(view)];
      const std::int64_t room = out_view["byteLength"];
      const std::string type = Text(accessor, "type");
      const auto components = kComponents.find(type);
      if (components == kComponents.end()) Refuse(where + ": unknown type");
      const std::int64_t component =
          Whole(accessor, "componentType", where, 5120, kFloat);
      const std::int64_t element =
          components->second * (component >= kUnsignedInt        ? 4
                                : component >= kUnsignedByte + 1 ? 2
                                                                 : 1);
      const std::int64_t stride = out_view.value("byteStride", element);
      if (stride < element) Refuse(where + ": longer than its view's stride");
      const std::int64_t offset =
          Whole(accessor, "byteOffset", where, 0, room, 0);
      const std::int64_t count = Whole(
          accessor, "count", where, 1, 3 * std::int64_t{kMaxMeshTriangles});
      if (offset + stride * (count - 1) + element > room) {
        Refuse(where + ": its " + std::to_string(count) +
               " elements do not fit into bufferViews[" + std::to_string(view) +
               "]");
      }
      out_["accessors"].push_back({{"bufferView", view},
                                   {"byteOffset", offset},
                                   {"componentType", component},
                                   {"count", count},
                                   {"type", type}});
    }
  }

  void CleanImages() {
    const Json& images = Items("images");
    for (std::size_t i = 0; i < images.size(); ++i) {
      const std::string where = Entry("images", i);
      const std::string uri = Text(images[i], "uri");
      MeshSource::Image image;
      image.name = where;
      if (uri.empty()) {
        const std::int64_t index =
            Index(images[i], "bufferView", where, "bufferViews");
        const Json& view = out_["bufferViews"][static_cast<std::size_t>(index)];
        image.bytes =
            source_.files
                .at("buffer" +
                    std::to_string(view["buffer"].get<std::int64_t>()) + ".bin")
                .substr(view["byteOffset"].get<std::size_t>(),
                        view["byteLength"].get<std::size_t>());
      } else if (uri.starts_with("data:")) {
        image.bytes = Resolve(uri, where);
      } else {
        image.name = uri;
        image.path = FilePath(uri);
      }
      source_.images.push_back(std::move(image));
      out_["images"].push_back({{"uri", MeshImageName(i)}});
    }
    const Json& textures = Items("textures");
    for (std::size_t i = 0; i < textures.size(); ++i) {
      out_["textures"].push_back(
          {{"source",
            Index(textures[i], "source", Entry("textures", i), "images")}});
    }
  }

  // The texture under a key of a material, by its first coordinates.
  std::optional<Json> TextureOf(const Json& object,
                                const std::string& key,
                                const std::string& where) const {
    const Json* texture = Child(object, key);
    if (texture == nullptr) return std::nullopt;
    if (Whole(*texture, "texCoord", where + ", " + key, 0, 7, 0) != 0) {
      Refuse(where + ": " + key + " uses other than the first coordinates");
    }
    return Json{
        {"index", Index(*texture, "index", where + ", " + key, "textures")}};
  }

  void CleanMaterials() {
    const Json& materials = Items("materials");
    for (std::size_t i = 0; i < materials.size(); ++i) {
      const std::string where = Entry("materials", i);
      const Json* extensions = Child(materials[i], "extensions");
      const Json* gloss =
          extensions == nullptr
              ? nullptr
              : Child(*extensions, "KHR_materials_pbrSpecularGlossiness");
      const Json* metal = Child(materials[i], "pbrMetallicRoughness");
      std::optional<Json> texture;
      std::optional<Json> factor;
      if (gloss != nullptr) {
        texture = TextureOf(*gloss, "diffuseTexture", where);
        factor = Numbers(*gloss, "diffuseFactor", where, 4, 0.0, 1.0);
      } else if (metal != nullptr) {
        texture = TextureOf(*metal, "baseColorTexture", where);
        factor = Numbers(*metal, "baseColorFactor", where, 4, 0.0, 1.0);
      }
      // What only shines has its looks in what it gives off.
      if (!texture) {
        texture = TextureOf(materials[i], "emissiveTexture", where);
      }
      Json base = Json::object();
      if (texture) base["baseColorTexture"] = *texture;
      if (factor) base["baseColorFactor"] = *factor;
      const std::string name = Text(materials[i], "name");
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
    const std::int64_t index = Index(object, key, where, "accessors");
    const Json& accessor = out_["accessors"][static_cast<std::size_t>(index)];
    const std::int64_t component = accessor["componentType"];
    const bool fits = is_index ? component == kUnsignedByte ||
                                     component == kUnsignedShort ||
                                     component == kUnsignedInt
                               : component == kFloat;
    if (!fits || accessor["type"] != type) {
      Refuse(where + ": " + key + " must be " + type + " of " +
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
        Refuse(where + ": index " + std::to_string(value) + ", but there are " +
               std::to_string(num_vertices) + " vertices");
      }
    }
  }

  Json CleanPrimitive(const Json& primitive, const std::string& where) {
    const Json* attributes = Child(primitive, "attributes");
    if (attributes == nullptr) Refuse(where + ": no attributes");
    const std::int64_t position =
        AccessorOf(*attributes, "POSITION", where, "VEC3", false);
    Json out = {{"attributes", {{"POSITION", position}}}, {"mode", kTriangles}};
    std::int64_t num_corners = CountOf(position);
    if (attributes->contains("TEXCOORD_0")) {
      const std::int64_t uv =
          AccessorOf(*attributes, "TEXCOORD_0", where, "VEC2", false);
      if (CountOf(uv) != CountOf(position)) {
        Refuse(where + ": not as many TEXCOORD_0 as POSITION");
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
      Refuse(where + ": " + std::to_string(num_corners) +
             " corners are no whole number of triangles");
    }
    if (primitive.contains("material")) {
      out["material"] = Index(primitive, "material", where, "materials");
    }
    num_triangles_.back() += num_corners / 3;
    return out;
  }

  void CleanMeshes() {
    const Json& meshes = Items("meshes");
    for (std::size_t i = 0; i < meshes.size(); ++i) {
      const auto primitives = meshes[i].find("primitives");
      if (primitives == meshes[i].end() || !primitives->is_array()) {
        Refuse(Entry("meshes", i) + ": no primitives");
      }
      num_triangles_.push_back(0);
      Json kept = Json::array();
      for (std::size_t k = 0; k < primitives->size(); ++k) {
        const Json& primitive = (*primitives)[k];
        const std::string where =
            Entry("meshes", i) + "." + Entry("primitives", k);
        if (!primitive.is_object()) Refuse(where + ": not an object");
        const std::int64_t mode =
            Whole(primitive, "mode", where, 0, 6, kTriangles);
        if (mode < kTriangles) continue;  // Points and lines.
        if (mode > kTriangles) {
          Refuse(where + ": strips and fans of triangles are not read here");
        }
        kept.push_back(CleanPrimitive(primitive, where));
      }
      out_["meshes"].push_back({{"primitives", std::move(kept)}});
    }
  }

  // Copies the node and what hangs on it; returns its new index. Only what is
  // reached from the scene is kept, as often as it is reached.
  std::int64_t AddNode(std::int64_t index, int depth) {
    const Json& node = Items("nodes")[static_cast<std::size_t>(index)];
    const std::string where = Entry("nodes", static_cast<std::size_t>(index));
    if (depth > kMaxDepth) {
      Refuse(where + ": more than " + std::to_string(kMaxDepth) +
             " nodes in one another");
    }
    if (out_["nodes"].size() >= static_cast<std::size_t>(kMaxItems)) {
      Refuse("more than " + std::to_string(kMaxItems) + " nodes in the scene");
    }
    Json out = Json::object();
    // Bounds keep products of many within floats; those of a scene are tens.
    constexpr double kFar = 1e6;
    const auto take = [&](const char* key, std::size_t count, double bound) {
      if (const auto numbers =
              Numbers(node, key, where, count, -bound, bound)) {
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
      const std::int64_t mesh = Index(node, "mesh", where, "meshes");
      total_ += num_triangles_[static_cast<std::size_t>(mesh)];
      if (total_ > kMaxMeshTriangles) {
        Refuse("more than " + std::to_string(kMaxMeshTriangles) + " triangles");
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
    const std::size_t count = Items("nodes").size();
    if (!found->is_array()) Refuse(where + ": " + key + " is not an array");
    for (const Json& index : *found) {
      if (!index.is_number_unsigned() || index.get<std::uint64_t>() >= count) {
        Refuse(where + ": " + key + " has " + index.dump(-1, ' ', true) +
               ", but there are " + std::to_string(count) + " nodes");
      }
      indices.push_back(index.get<std::int64_t>());
    }
    return indices;
  }

  void CleanNodes() {
    out_["nodes"] = Json::array();
    const Json& scenes = Items("scenes");
    if (scenes.empty()) Refuse("no scenes");
    const std::int64_t scene =
        Whole(document_,
              "scene",
              "the file",
              0,
              static_cast<std::int64_t>(scenes.size()) - 1,
              0);
    const std::string where = Entry("scenes", static_cast<std::size_t>(scene));
    Json roots = Json::array();
    for (const std::int64_t node :
         Indices(scenes[static_cast<std::size_t>(scene)], "nodes", where)) {
      roots.push_back(AddNode(node, 0));
    }
    if (total_ == 0) Refuse(where + ": no triangles");
    out_["scenes"] = Json::array({Json{{"nodes", roots}}});
    out_["scene"] = 0;
  }

  std::string path_;
  Json document_;
  std::string binary_;  // The second chunk of binary glTF.
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
