#include "drivers/simulator/gltf_document.h"

#include "drivers/simulator/mesh_file.h"
#include "estimation/base/input_error.h"
#include "estimation/base/whole_file.h"

#include <filesystem>
#include <string_view>

namespace waymark {

using Json = GltfDocument::Json;

namespace {

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

}  // namespace

GltfDocument::GltfDocument(const std::string& path) : path_(path) {
  Read();
  CheckHead();
  CheckItems();
}

void GltfDocument::Refuse(const std::string& what) const {
  throw InputError(path_ + ": " + what);
}

void GltfDocument::Read() {
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
    root_ = Json::parse(text);
  } catch (const Json::parse_error& error) {
    Refuse("not JSON at byte " + std::to_string(error.byte));
  } catch (const Json::exception&) {  // A number beyond a double.
    Refuse("not JSON: a number out of range");
  }
  if (!root_.is_object()) Refuse("not a glTF file: no object");
}

void GltfDocument::CheckHead() const {
  const Json* asset = Child(root_, "asset");
  if (asset == nullptr || !Text(*asset, "version").starts_with("2.")) {
    Refuse("asset: version must be 2.x");
  }
  const auto required = root_.find("extensionsRequired");
  if (required == root_.end()) return;
  if (!required->is_array()) Refuse("extensionsRequired: not an array");
  for (const Json& name : *required) {
    if (!name.is_string() ||
        !name.get<std::string>().starts_with("KHR_materials_")) {
      Refuse("needs the extension " + name.dump(-1, ' ', true) +
             ", which is not read here (KHR_materials_* are)");
    }
  }
}

void GltfDocument::CheckItems() const {
  for (const char* key : {"accessors",
                          "bufferViews",
                          "buffers",
                          "images",
                          "materials",
                          "meshes",
                          "nodes",
                          "scenes",
                          "textures"}) {
    const auto found = root_.find(key);
    if (found == root_.end()) continue;
    if (!found->is_array() ||
        found->size() > static_cast<std::size_t>(kMaxItems)) {
      Refuse(std::string(key) + ": not an array of at most " +
             std::to_string(kMaxItems));
    }
    for (const Json& item : *found) {
      if (!item.is_object()) {
        Refuse(std::string(key) + ": an entry is not an object");
      }
    }
  }
}

const Json& GltfDocument::Items(const std::string& key) const {
  static const Json kNone = Json::array();
  const auto found = root_.find(key);
  return found == root_.end() ? kNone : *found;
}

std::int64_t GltfDocument::Whole(const Json& object,
                                 const std::string& key,
                                 const std::string& where,
                                 std::int64_t low,
                                 std::int64_t high,
                                 std::optional<std::int64_t> otherwise) const {
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

std::int64_t GltfDocument::Index(const Json& object,
                                 const std::string& key,
                                 const std::string& where,
                                 const std::string& list) const {
  const std::size_t count = Items(list).size();
  if (count == 0) Refuse(where + ": " + key + ", but there are no " + list);
  return Whole(object, key, where, 0, static_cast<std::int64_t>(count) - 1);
}

std::optional<Json> GltfDocument::Numbers(const Json& object,
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
           " numbers in [" + std::to_string(low) + ", " + std::to_string(high) +
           "]");
  }
  return *found;
}

const Json* GltfDocument::Child(const Json& object, const std::string& key) {
  const auto found = object.find(key);
  return found != object.end() && found->is_object() ? &*found : nullptr;
}

std::string GltfDocument::Text(const Json& object, const std::string& key) {
  const auto found = object.find(key);
  return found != object.end() && found->is_string() ? found->get<std::string>()
                                                     : std::string();
}

std::string GltfDocument::Entry(const std::string& list, std::size_t i) {
  return list + "[" + std::to_string(i) + "]";
}

std::string GltfDocument::Resolve(const std::string& uri,
                                  const std::string& where) const {
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

std::string GltfDocument::FilePath(const std::string& uri) const {
  const std::filesystem::path folder =
      std::filesystem::path(path_).parent_path();
  return (folder / FromPercent(uri)).string();
}

}  // namespace waymark
