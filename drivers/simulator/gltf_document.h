// The JSON of a glTF file, and values out of it that are checked.
#pragma once

#include <nlohmann/json.hpp>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

namespace waymark {

// Everything here throws InputError naming the file and the place in it.
class GltfDocument {
 public:
  using Json = nlohmann::json;
  static constexpr std::int64_t kMaxItems = 100'000;  // Of each kind.

  // Reads a file, text (.gltf) or binary (.glb). Refuses another version than
  // 2.x and what needs extensions first, whatever else is wrong.
  explicit GltfDocument(const std::string& path);

  [[noreturn]] void Refuse(const std::string& what) const;

  [[nodiscard]] const Json& root() const { return root_; }
  // The second chunk of binary glTF.
  [[nodiscard]] const std::string& binary() const { return binary_; }

  // The array of objects under a key of the root; empty where missing.
  [[nodiscard]] const Json& Items(const std::string& key) const;
  // Whole number in [low, high]; `otherwise` where the key is missing.
  [[nodiscard]] std::int64_t Whole(
      const Json& object,
      const std::string& key,
      const std::string& where,
      std::int64_t low,
      std::int64_t high,
      std::optional<std::int64_t> otherwise = {}) const;
  // Of an entry of Items(list).
  [[nodiscard]] std::int64_t Index(const Json& object,
                                   const std::string& key,
                                   const std::string& where,
                                   const std::string& list) const;
  // `count` numbers in [low, high], where the key is there.
  [[nodiscard]] std::optional<Json> Numbers(const Json& object,
                                            const std::string& key,
                                            const std::string& where,
                                            std::size_t count,
                                            double low,
                                            double high) const;
  // The object under a key; null where there is none.
  [[nodiscard]] static const Json* Child(const Json& object,
                                         const std::string& key);
  // The text under a key; empty where there is none.
  [[nodiscard]] static std::string Text(const Json& object,
                                        const std::string& key);
  // "list[i]".
  [[nodiscard]] static std::string Entry(const std::string& list,
                                         std::size_t i);

  // What a uri names: the content of a file, or of a data: uri.
  [[nodiscard]] std::string Resolve(const std::string& uri,
                                    const std::string& where) const;
  // The path of the file that a uri names.
  [[nodiscard]] std::string FilePath(const std::string& uri) const;

 private:
  void Read();
  void CheckHead() const;
  void CheckItems() const;

  std::string path_;
  Json root_;
  std::string binary_;
};

}  // namespace waymark
