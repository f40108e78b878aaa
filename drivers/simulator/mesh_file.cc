#include "drivers/simulator/mesh_file.h"

#include "drivers/simulator/mesh_source.h"
#include "drivers/video/image_file.h"
#include "estimation/base/check.h"
#include "estimation/base/input_error.h"

#include <assimp/BaseImporter.h>
#include <assimp/IOStream.hpp>
#include <assimp/IOSystem.hpp>
#include <assimp/Importer.hpp>
#include <assimp/importerdesc.h>
#include <assimp/material.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <stdexcept>
#include <utility>

namespace waymark {
namespace {

// Of a texture, from its first pixel: beyond it floats have no fraction left
// to find the pixel by.
constexpr float kMaxRepetitions = 10'000.0f;

// ---- files in memory for the library ---------------------------------------

class MemoryStream : public Assimp::IOStream {
 public:
  explicit MemoryStream(const std::string& bytes) : bytes_(bytes) {}

  size_t Read(void* buffer, size_t size, size_t count) override {
    if (size == 0) return 0;
    const size_t done = std::min(count, (bytes_.size() - at_) / size);
    std::memcpy(buffer, bytes_.data() + at_, done * size);
    at_ += done * size;
    return done;
  }
  size_t Write(const void*, size_t, size_t) override { return 0; }
  aiReturn Seek(size_t offset, aiOrigin origin) override {
    const size_t base = origin == aiOrigin_SET   ? 0
                        : origin == aiOrigin_CUR ? at_
                                                 : bytes_.size();
    if (offset > bytes_.size() - base) return aiReturn_FAILURE;
    at_ = base + offset;
    return aiReturn_SUCCESS;
  }
  [[nodiscard]] size_t Tell() const override { return at_; }
  [[nodiscard]] size_t FileSize() const override { return bytes_.size(); }
  void Flush() override {}

 private:
  const std::string& bytes_;
  size_t at_ = 0;
};

class MemoryFiles : public Assimp::IOSystem {
 public:
  explicit MemoryFiles(const std::map<std::string, std::string>& files)
      : files_(files) {}

  bool Exists(const char* name) const override {
    return Find(name) != files_.end();
  }
  [[nodiscard]] char getOsSeparator() const override { return '/'; }
  Assimp::IOStream* Open(const char* name, const char*) override {
    const auto found = Find(name);
    return found == files_.end() ? nullptr : new MemoryStream(found->second);
  }
  void Close(Assimp::IOStream* stream) override { delete stream; }

 private:
  // The library puts folders such as "./" in front.
  [[nodiscard]] std::map<std::string, std::string>::const_iterator Find(
      const char* name) const {
    return files_.find(std::filesystem::path(name).filename().string());
  }

  const std::map<std::string, std::string>& files_;
};

// Leaves the importers of glTF 2.0 and OBJ.
void DropOtherImporters(Assimp::Importer* importer) {
  std::vector<Assimp::BaseImporter*> others;
  for (size_t i = 0; i < importer->GetImporterCount(); ++i) {
    const std::string name = importer->GetImporterInfo(i)->mName;
    if (name != "glTF2 Importer" && name != "Wavefront Object Importer") {
      others.push_back(importer->GetImporter(i));
    }
  }
  for (Assimp::BaseImporter* other : others) {
    importer->UnregisterLoader(other);  // And no longer owned.
    delete other;
  }
}

// ---- materials -------------------------------------------------------------

// sRGB value of a linear factor times a linear value.
double Curve(double linear) {
  return linear <= 0.0031308 ? 12.92 * linear
                             : 1.055 * std::pow(linear, 1.0 / 2.4) - 0.055;
}

double Linear(double value) {
  return value <= 0.04045 ? value / 12.92
                          : std::pow((value + 0.055) / 1.055, 2.4);
}

cv::Mat3b Halved(cv::Mat3b image, int max_side) {
  while (std::max(image.cols, image.rows) > max_side) {
    const cv::Size half(std::max(1, image.cols / 2),
                        std::max(1, image.rows / 2));
    cv::Mat3b smaller;
    cv::resize(image, smaller, half, 0.0, 0.0, cv::INTER_AREA);
    image = smaller;
  }
  return image;
}

class MeshFile {
 public:
  MeshFile(const std::string& path,
           const std::string& name,
           const MeshFileOptions& options)
      : path_(path), name_(name), options_(options) {}

  // Reads everything before it changes `scene`.
  MeshFileReport Append(Scene* scene) {
    source_ = ReadSource();
    Assimp::Importer importer;
    DropOtherImporters(&importer);
    // Owned by the importer.
    importer.SetIOHandler(new MemoryFiles(source_.files));
    importer.SetPropertyInteger(AI_CONFIG_PP_SBP_REMOVE,
                                aiPrimitiveType_POINT | aiPrimitiveType_LINE);
    const aiScene* model = importer.ReadFile(
        source_.main,
        aiProcess_Triangulate | aiProcess_SortByPType |
            aiProcess_PreTransformVertices | aiProcess_ValidateDataStructure);
    if (model == nullptr || model->mNumMeshes == 0) {
      throw InputError(
          path_ + ": cannot be read as a mesh: " + importer.GetErrorString());
    }
    for (unsigned i = 0; i < model->mNumMeshes; ++i) {
      AddMesh(*model, *model->mMeshes[i]);
    }
    if (mesh_.triangles.empty()) throw InputError(path_ + ": no triangles");
    CheckExtent();
    AppendTo(scene);
    return report_;
  }

 private:
  [[nodiscard]] MeshSource ReadSource() const {
    std::string extension = std::filesystem::path(path_).extension().string();
    std::transform(extension.begin(),
                   extension.end(),
                   extension.begin(),
                   [](unsigned char c) {
                     return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32)
                                                 : static_cast<char>(c);
                   });
    if (extension == ".gltf" || extension == ".glb") {
      return ReadGltfSource(path_);
    }
    if (extension == ".obj") return ReadObjSource(path_);
    throw InputError(path_ + ": a mesh file ends in .gltf, .glb or .obj");
  }

  void AddMesh(const aiScene& model, const aiMesh& mesh) {
    const std::uint32_t material =
        MaterialOf(mesh.mMaterialIndex, *model.mMaterials[mesh.mMaterialIndex]);
    const auto first = static_cast<std::uint32_t>(mesh_.positions.size());
    const bool has_uvs = mesh.HasTextureCoords(0);
    for (unsigned i = 0; i < mesh.mNumVertices; ++i) {
      const aiVector3D& p = mesh.mVertices[i];
      const Eigen::Vector3d p_M = options_.is_y_up
                                      ? Eigen::Vector3d(p.x, -p.z, p.y)
                                      : Eigen::Vector3d(p.x, p.y, p.z);
      const Eigen::Vector3d p_W = options_.X_WM * (options_.scale * p_M);
      if (!p_W.allFinite())
        throw InputError(path_ + ": a vertex is not finite");
      mesh_.positions.push_back(p_W.cast<float>());
      report_.box_W.extend(p_W);
      // The library's v goes up.
      const aiVector3D uv =
          has_uvs ? mesh.mTextureCoords[0][i] : aiVector3D(0.0f, 1.0f, 0.0f);
      mesh_.uvs.emplace_back(uv.x, 1.0f - uv.y);
      if (!(mesh_.uvs.back().array().abs() <= kMaxRepetitions).all()) {
        throw InputError(path_ + ": a texture coordinate is not in [-10000, " +
                         "10000]");
      }
    }
    for (unsigned i = 0; i < mesh.mNumFaces; ++i) {
      const aiFace& face = mesh.mFaces[i];
      if (face.mNumIndices != 3) continue;
      mesh_.triangles.push_back({{first + face.mIndices[0],
                                  first + face.mIndices[1],
                                  first + face.mIndices[2]},
                                 material,
                                 0});
    }
    if (mesh_.triangles.size() > kMaxMeshTriangles) {
      throw InputError(path_ + ": more than " +
                       std::to_string(kMaxMeshTriangles) + " triangles");
    }
  }

  // Index into materials_ of a material of the file, loaded once.
  std::uint32_t MaterialOf(unsigned index, const aiMaterial& material) {
    const auto known = indices_.find(index);
    if (known != indices_.end()) return known->second;
    const std::string label = material.GetName().C_Str();
    SceneMaterial out;
    out.name = name_ + (label.empty() ? "" : " " + label);
    out.is_emissive = options_.has_baked_light;
    aiColor4D color(1.0f, 1.0f, 1.0f, 1.0f);
    const bool has_color =
        material.Get(AI_MATKEY_BASE_COLOR, color) == aiReturn_SUCCESS ||
        material.Get(AI_MATKEY_COLOR_DIFFUSE, color) == aiReturn_SUCCESS;
    aiString texture;
    if (material.GetTexture(aiTextureType_DIFFUSE, 0, &texture) ==
        aiReturn_SUCCESS) {
      out.texture = Colored(TextureOf(texture.C_Str(), label), color);
    } else {
      constexpr std::uint8_t kLightGrey = 204;
      const std::uint8_t grey = has_color ? 255 : kLightGrey;
      out.texture =
          Colored(cv::Mat3b(1, 1, cv::Vec3b(grey, grey, grey)), color);
    }
    const auto place = static_cast<std::uint32_t>(materials_.size());
    materials_.push_back(std::move(out));
    return indices_.emplace(index, place).first->second;
  }

  cv::Mat3b TextureOf(const std::string& image, const std::string& material) {
    std::size_t index = source_.images.size();
    const std::size_t prefix = MeshImageName(0).size() - 1;
    std::from_chars(image.data() + std::min(prefix, image.size()),
                    image.data() + image.size(),
                    index);
    WAYMARK_CHECK(index < source_.images.size(), image);
    const auto known = textures_.find(index);
    if (known != textures_.end()) return known->second;
    const MeshSource::Image& source = source_.images[index];
    const std::string where = path_ + ", material '" + material + "', texture ";
    cv::Mat3b texture;
    try {
      texture =
          source.path.empty()
              ? DecodeImage(
                    {reinterpret_cast<const std::uint8_t*>(source.bytes.data()),
                     source.bytes.size()},
                    source.name,
                    ImageFileColor::kBgr)
              : LoadImageFile(source.path, ImageFileColor::kBgr);
    } catch (const InputError& error) {
      throw InputError(where + error.what());
    }
    ++report_.num_textures;
    texture = Halved(texture, options_.max_texture_side);
    textures_[index] = texture;
    return texture;
  }

  // The texture times the material's colour.
  [[nodiscard]] cv::Mat3b Colored(const cv::Mat3b& texture,
                                  const aiColor4D& color) const {
    const std::array<float, 3> factors{color.b, color.g, color.r};
    if (factors == std::array{1.0f, 1.0f, 1.0f}) return texture;
    cv::Mat3b table(1, 256);
    for (int value = 0; value < 256; ++value) {
      for (int i = 0; i < 3; ++i) {
        const double factor =
            std::clamp(factors[static_cast<std::size_t>(i)], 0.0f, 1.0f);
        const double x = value / 255.0;
        const double colored =
            source_.has_linear_colors ? Curve(factor * Linear(x)) : factor * x;
        table(0, value)[i] =
            static_cast<std::uint8_t>(std::lround(255.0 * colored));
      }
    }
    cv::Mat3b out;
    cv::LUT(texture, table, out);
    return out;
  }

  void CheckExtent() const {
    const Eigen::AlignedBox3d& box = report_.box_W;
    const double reach = std::max(box.max().maxCoeff(), -box.min().minCoeff());
    if (!(reach <= kMaxMeshExtent)) {
      throw InputError(path_ + ": reaches " + std::to_string(reach) +
                       " m from the world's origin with this scale and place," +
                       " more than 200 m");
    }
  }

  void AppendTo(Scene* scene) {
    const auto vertex =
        static_cast<std::uint32_t>(scene->mesh.positions.size());
    const auto material = static_cast<std::uint32_t>(scene->materials.size());
    const auto surface = static_cast<std::uint32_t>(scene->surfaces.size());
    report_.num_triangles = static_cast<int>(mesh_.triangles.size());
    report_.num_materials = static_cast<int>(materials_.size());
    scene->surfaces.push_back({name_, options_.kind});
    const auto append = [](auto& from, auto* to) {
      to->insert(to->end(),
                 std::make_move_iterator(from.begin()),
                 std::make_move_iterator(from.end()));
    };
    append(materials_, &scene->materials);
    append(mesh_.positions, &scene->mesh.positions);
    append(mesh_.uvs, &scene->mesh.uvs);
    for (SceneTriangle triangle : mesh_.triangles) {
      for (std::uint32_t& corner : triangle.vertices) corner += vertex;
      triangle.material += material;
      triangle.surface = surface;
      scene->mesh.triangles.push_back(triangle);
    }
  }

  std::string path_;
  std::string name_;
  MeshFileOptions options_;
  MeshSource source_;
  SceneMesh mesh_;
  std::vector<SceneMaterial> materials_;
  std::map<unsigned, std::uint32_t> indices_;
  std::map<std::size_t, cv::Mat3b> textures_;
  MeshFileReport report_;
};

}  // namespace

void MeshFileOptions::Check() const {
  if (!(scale >= 1e-6 && scale <= 1e6)) {
    throw std::invalid_argument("mesh file: scale = " + std::to_string(scale) +
                                ", not in [1e-6, 1e6]");
  }
  if (!X_WM.matrix().allFinite()) {
    throw std::invalid_argument("mesh file: X_WM is not finite");
  }
  if (max_texture_side < 1 || max_texture_side > kMaxImageFileSide) {
    throw std::invalid_argument(
        "mesh file: max_texture_side = " + std::to_string(max_texture_side) +
        ", not in [1, " + std::to_string(kMaxImageFileSide) + "]");
  }
}

MeshFileReport AppendMeshFile(const std::string& path,
                              const std::string& name,
                              const MeshFileOptions& options,
                              Scene* scene) {
  options.Check();
  return MeshFile(path, name, options).Append(scene);
}

}  // namespace waymark
