#include "processes/support/message_schema.h"

#include "estimation/base/input_error.h"
#include "processes/support/schema_parser.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>

namespace waymark {
namespace {

// lcm-gen's hash, on signed numbers as there (the right shift keeps the sign).
std::int64_t Mix(std::int64_t hash, std::int64_t byte) {
  const std::uint64_t mixed = (static_cast<std::uint64_t>(hash) << 8) ^
                              static_cast<std::uint64_t>(hash >> 55);
  return static_cast<std::int64_t>(mixed + static_cast<std::uint64_t>(byte));
}

std::int64_t Mix(std::int64_t hash, std::string_view text) {
  hash = Mix(hash, static_cast<signed char>(text.size()));
  for (const char c : text) hash = Mix(hash, static_cast<signed char>(c));
  return hash;
}

std::uint64_t OwnHash(const MessageSchema& schema) {
  std::int64_t hash = 0x12345678;
  for (const auto& field : schema.fields) {
    hash = Mix(hash, field.name);
    if (field.kind != FieldKind::kStruct) hash = Mix(hash, field.type);
    hash = Mix(hash, static_cast<std::int64_t>(field.dimensions.size()));
    for (const auto& dimension : field.dimensions) {
      hash = Mix(hash, dimension.length_field >= 0 ? 1 : 0);
      hash = Mix(hash, dimension.size);
    }
  }
  return static_cast<std::uint64_t>(hash);
}

// Hashes of types within types. A type inside itself counts 0, so the hash of a
// type depends on the types around it, but only where it leads back to them.
class NestedHasher {
 public:
  std::uint64_t Hash(const MessageSchema& schema) {
    if (const auto known = known_.find(&schema); known != known_.end()) {
      return known->second;
    }
    if (std::find(outer_.begin(), outer_.end(), &schema) != outer_.end()) {
      ++num_cut_;
      return 0;
    }
    // Real types nest three or four deep, and few contain themselves.
    constexpr std::size_t kMaxDepth = 64;
    constexpr int kMaxSteps = 100'000;
    if (outer_.size() >= kMaxDepth || ++num_steps_ > kMaxSteps) {
      throw InputError(schema.origin + ": " + schema.name +
                       " is part of types that nest too deeply");
    }
    const std::int64_t num_cut_before = num_cut_;
    outer_.push_back(&schema);
    std::uint64_t hash = OwnHash(schema);
    for (const auto& field : schema.fields) {
      if (field.nested != nullptr) hash += Hash(*field.nested);
    }
    outer_.pop_back();
    hash = hash << 1 | hash >> 63;
    if (num_cut_ == num_cut_before) known_.emplace(&schema, hash);
    return hash;
  }

 private:
  std::map<const MessageSchema*, std::uint64_t> known_;  // Lead nowhere back.
  std::vector<const MessageSchema*> outer_;
  std::int64_t num_cut_ = 0;
  int num_steps_ = 0;
};

}  // namespace

std::uint64_t Fingerprint(const MessageSchema& schema) {
  return NestedHasher().Hash(schema);
}

SchemaSet::SchemaSet(const std::vector<Source>& sources) {
  for (const auto& source : sources) {
    for (auto& schema : ParseSchemas(source.text, source.name)) {
      const auto [found, is_new] = by_name_.try_emplace(schema.name, schema);
      if (is_new) {
        types_.push_back(&found->second);
      } else if (OwnHash(found->second) != OwnHash(schema)) {
        throw InputError(schema.origin + ": " + schema.name +
                         " has other members than in " + found->second.origin);
      }
    }
  }
  Resolve();
}

void SchemaSet::Resolve() {
  for (auto& [name, schema] : by_name_) {
    for (auto& field : schema.fields) {
      if (field.kind != FieldKind::kStruct) continue;
      field.nested = FindByName(field.type);
      if (field.nested == nullptr) {
        throw InputError(schema.origin + ": " + name + "." + field.name +
                         " is of type " + field.type +
                         ", which is not defined");
      }
    }
  }
  NestedHasher hasher;
  for (const auto* type : types_) {
    by_fingerprint_.emplace(hasher.Hash(*type), type);
  }
}

const MessageSchema* SchemaSet::FindByName(std::string_view name) const {
  const auto found = by_name_.find(name);
  return found == by_name_.end() ? nullptr : &found->second;
}

std::vector<const MessageSchema*> SchemaSet::FindByFingerprint(
    std::uint64_t fingerprint) const {
  std::vector<const MessageSchema*> result;
  const auto [first, last] = by_fingerprint_.equal_range(fingerprint);
  for (auto i = first; i != last; ++i) result.push_back(i->second);
  return result;
}

std::vector<SchemaSet::Source> ReadSchemaFolder(const std::string& folder) {
  namespace fs = std::filesystem;
  std::vector<std::string> paths;
  try {
    for (const auto& entry : fs::recursive_directory_iterator(folder)) {
      if (entry.is_regular_file() && entry.path().extension() == ".lcm") {
        paths.push_back(entry.path().string());
      }
    }
  } catch (const fs::filesystem_error& error) {
    throw InputError(folder + ": cannot be read as a folder of .lcm files: " +
                     error.code().message());
  }
  if (paths.empty()) throw InputError(folder + ": has no .lcm files");
  std::sort(paths.begin(), paths.end());
  std::vector<SchemaSet::Source> sources;
  for (const auto& path : paths) {
    std::ifstream in(path, std::ios::binary);
    if (!in) throw InputError(path + ": cannot be read");
    sources.push_back({path,
                       {std::istreambuf_iterator<char>(in),
                        std::istreambuf_iterator<char>()}});
  }
  return sources;
}

}  // namespace waymark
