#include "drivers/simulator/gltf_data.h"

#include "drivers/simulator/mesh_file.h"

#include <map>
#include <utility>

namespace waymark {
namespace {

using Json = GltfDocument::Json;

constexpr int kUnsignedByte = 5121;
constexpr int kUnsignedShort = 5123;
constexpr int kUnsignedInt = 5125;
constexpr int kFloat = 5126;

// Of one number of an accessor.
std::int64_t BytesOf(std::int64_t component_type) {
  if (component_type >= kUnsignedInt) return 4;
  return component_type > kUnsignedByte ? 2 : 1;
}

std::string BufferName(std::int64_t index) {
  return "buffer" + std::to_string(index) + ".bin";
}

}  // namespace

GltfData::GltfData(const GltfDocument& document) : document_(document) {
  CleanBuffers();
  CleanViews();
  CleanAccessors();
  CleanImages();
  CleanTextures();
}

void GltfData::CleanBuffers() {
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
    const std::string name = BufferName(static_cast<std::int64_t>(i));
    files_[name] = std::move(bytes);
    clean_["buffers"].push_back({{"byteLength", length}, {"uri", name}});
  }
}

void GltfData::CleanViews() {
  const Json& views = document_.Items("bufferViews");
  for (std::size_t i = 0; i < views.size(); ++i) {
    const std::string where = GltfDocument::Entry("bufferViews", i);
    const std::int64_t buffer =
        document_.Index(views[i], "buffer", where, "buffers");
    const std::int64_t size =
        clean_["buffers"][static_cast<std::size_t>(buffer)]["byteLength"];
    const std::int64_t offset =
        document_.Whole(views[i], "byteOffset", where, 0, size, 0);
    const std::int64_t length =
        document_.Whole(views[i], "byteLength", where, 1, size - offset);
    const std::int64_t stride =
        document_.Whole(views[i], "byteStride", where, 0, 252, 0);
    Json view = {
        {"buffer", buffer}, {"byteOffset", offset}, {"byteLength", length}};
    if (stride > 0) view["byteStride"] = stride;
    clean_["bufferViews"].push_back(std::move(view));
  }
}

void GltfData::CleanAccessors() {
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
        clean_["bufferViews"][static_cast<std::size_t>(view)];
    const std::int64_t room = out_view["byteLength"];
    const std::string type = GltfDocument::Text(accessor, "type");
    const auto components = kComponents.find(type);
    if (components == kComponents.end())
      document_.Refuse(where + ": unknown type");
    const std::int64_t component =
        document_.Whole(accessor, "componentType", where, 5120, kFloat);
    const std::int64_t element = components->second * BytesOf(component);
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
    clean_["accessors"].push_back({{"bufferView", view},
                                   {"byteOffset", offset},
                                   {"componentType", component},
                                   {"count", count},
                                   {"type", type}});
  }
}

void GltfData::CleanImages() {
  const Json& images = document_.Items("images");
  for (std::size_t i = 0; i < images.size(); ++i) {
    const std::string where = GltfDocument::Entry("images", i);
    const std::string uri = GltfDocument::Text(images[i], "uri");
    MeshSource::Image image;
    image.name = where;
    if (uri.empty()) {
      const std::int64_t index =
          document_.Index(images[i], "bufferView", where, "bufferViews");
      const Json& view = clean_["bufferViews"][static_cast<std::size_t>(index)];
      image.bytes = files_.at(BufferName(view["buffer"]))
                        .substr(view["byteOffset"].get<std::size_t>(),
                                view["byteLength"].get<std::size_t>());
    } else if (uri.starts_with("data:")) {
      image.bytes = document_.Resolve(uri, where);
    } else {
      image.name = uri;
      image.path = document_.FilePath(uri);
    }
    images_.push_back(std::move(image));
    clean_["images"].push_back({{"uri", MeshImageName(i)}});
  }
}

void GltfData::CleanTextures() {
  const Json& textures = document_.Items("textures");
  for (std::size_t i = 0; i < textures.size(); ++i) {
    clean_["textures"].push_back(
        {{"source",
          document_.Index(textures[i],
                          "source",
                          GltfDocument::Entry("textures", i),
                          "images")}});
  }
}

std::int64_t GltfData::AccessorOf(const Json& object,
                                  const std::string& key,
                                  const std::string& where,
                                  const std::string& type,
                                  bool is_index) const {
  const std::int64_t index = document_.Index(object, key, where, "accessors");
  const Json& accessor = clean_["accessors"][static_cast<std::size_t>(index)];
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

std::int64_t GltfData::CountOf(std::int64_t accessor) const {
  return clean_["accessors"][static_cast<std::size_t>(accessor)]["count"];
}

void GltfData::CheckIndices(std::int64_t index,
                            std::int64_t num_vertices,
                            const std::string& where) const {
  const Json& accessor = clean_["accessors"][static_cast<std::size_t>(index)];
  const Json& view =
      clean_["bufferViews"][accessor["bufferView"].get<std::size_t>()];
  const std::string& bytes = files_.at(BufferName(view["buffer"]));
  const auto size =
      static_cast<std::size_t>(BytesOf(accessor["componentType"]));
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

}  // namespace waymark
