#include "drivers/simulator/mesh_file.h"

#include "estimation/base/input_error.h"
#include "tests/support/real_data.h"
#include "tests/support/temporary_directory.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <stdexcept>
#include <string>
#include <vector>

namespace waymark {
namespace {

using testing::AllOf;
using testing::HasSubstr;

class MeshFileTest : public testing::Test {
 protected:
  std::string Write(const std::string& name, const std::string& content) {
    std::string path = folder_ / name;
    std::ofstream(path, std::ios::binary) << content;
    return path;
  }

  // 2 x 2 pixels: red, green over blue, grey.
  std::string WriteTexture(const std::string& name) {
    cv::Mat3b image(2, 2);
    image << cv::Vec3b(0, 0, 200), cv::Vec3b(0, 200, 0), cv::Vec3b(200, 0, 0),
        cv::Vec3b(100, 100, 100);
    const std::string path = folder_ / name;
    cv::imwrite(path, image);
    return path;
  }

  // A square of 2 x 1 units, upright facing the file's +z, textured.
  std::string WriteObj() {
    WriteTexture("wall.png");
    Write("wall.mtl",
          "newmtl painted\nKd 1 1 1\nmap_Kd wall.png\n"
          "newmtl plain\nKd 0.5 0.25 1\n");
    return Write("wall.obj",
                 "mtllib wall.mtl\n"
                 "v 0 0 0\nv 2 0 0\nv 2 1 0\nv 0 1 0\n"
                 "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n"
                 "usemtl painted\nf 1/1 2/2 3/3 4/4\n"
                 "usemtl plain\nf -4 -3 -2\n");
  }

  std::string ErrorOf(const std::string& path,
                      const MeshFileOptions& options = {}) {
    Scene scene;
    try {
      AppendMeshFile(path, "model", options, &scene);
    } catch (const InputError& error) {
      EXPECT_TRUE(scene.materials.empty() && scene.mesh.positions.empty());
      return error.what();
    }
    return "none";
  }

  TemporaryDirectory folder_;
};

// Where a corner of that texture coordinate lies; the first one.
Eigen::Vector3f PlaceOf(const Scene& scene, float u, float v) {
  for (std::size_t i = 0; i < scene.mesh.uvs.size(); ++i) {
    if ((scene.mesh.uvs[i] - Eigen::Vector2f(u, v)).norm() < 1e-6f) {
      return scene.mesh.positions[i];
    }
  }
  ADD_FAILURE() << "no corner at " << u << ", " << v;
  return Eigen::Vector3f::Zero();
}

TEST_F(MeshFileTest, ObjIsTurnedUprightWithItsTextureUpright) {
  Scene scene;
  const MeshFileReport report = AppendMeshFile(WriteObj(), "wall", {}, &scene);
  CheckScene(scene);
  EXPECT_EQ(report.num_triangles, 3);
  EXPECT_EQ(report.num_materials, 2);
  EXPECT_EQ(report.num_textures, 1);
  // The file's y is up; its z comes toward -y of W.
  EXPECT_TRUE(report.box_W.min().isApprox(Eigen::Vector3d(0, 0, 0)));
  EXPECT_TRUE(report.box_W.max().isApprox(Eigen::Vector3d(2, 0, 1)));
  // The upper left corner of the image, (0, 0) of ours, is (0, 1) of the file.
  EXPECT_TRUE(PlaceOf(scene, 0, 0).isApprox(Eigen::Vector3f(0, 0, 1)));
  EXPECT_TRUE(PlaceOf(scene, 1, 1).isApprox(Eigen::Vector3f(2, 0, 0)));
  EXPECT_EQ(scene.materials[0].texture(0, 0), cv::Vec3b(0, 0, 200));
  EXPECT_FALSE(scene.materials[0].is_emissive);
  // Kd in the order of BGR, as an image shows it.
  EXPECT_EQ(scene.materials[1].texture(0, 0), cv::Vec3b(255, 64, 128));
}

TEST_F(MeshFileTest, ScaleAndPoseApplyAfterTheTurn) {
  Scene scene;
  MeshFileOptions options;
  options.scale = 2.0;
  options.X_WM.translation() = Eigen::Vector3d(10, 20, 30);
  options.X_WM.linear() =
      Eigen::AngleAxisd(std::numbers::pi / 2, Eigen::Vector3d::UnitZ())
          .toRotationMatrix();
  options.has_baked_light = true;
  const MeshFileReport report =
      AppendMeshFile(WriteObj(), "wall", options, &scene);
  // 2 units along x become 4 m along W's y. Rounding of floats.
  EXPECT_TRUE(report.box_W.min().isApprox(Eigen::Vector3d(10, 20, 30), 1e-6));
  EXPECT_TRUE(report.box_W.max().isApprox(Eigen::Vector3d(10, 24, 32), 1e-6));
  EXPECT_TRUE(scene.materials[0].is_emissive);

  options = {};
  options.is_y_up = false;
  EXPECT_TRUE(AppendMeshFile(WriteObj(), "wall", options, &scene)
                  .box_W.max()
                  .isApprox(Eigen::Vector3d(2, 1, 0)));
}

TEST_F(MeshFileTest, AppendsToWhatIsThere) {
  Scene scene;
  AppendMeshFile(WriteObj(), "one", {}, &scene);
  AppendMeshFile(WriteObj(), "two", {}, &scene);
  CheckScene(scene);
  ASSERT_EQ(scene.mesh.triangles.size(), 6u);
  EXPECT_EQ(scene.surfaces.at(scene.mesh.triangles[3].surface).name, "two");
  EXPECT_THAT(scene.materials.at(scene.mesh.triangles[3].material).name,
              HasSubstr("two"));
  EXPECT_GE(scene.mesh.triangles[3].vertices[0], 7u);
}

TEST_F(MeshFileTest, ObjErrorsNameFileAndLine) {
  const auto refuses = [&](const std::string& text, const std::string& what) {
    EXPECT_THAT(ErrorOf(Write("bad.obj", text)),
                AllOf(HasSubstr("bad.obj"), HasSubstr(what)));
  };
  const std::string corners = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
  refuses("", "no faces");
  refuses("v 0 0\n", "line 1: v: '' is not a number");
  refuses("v 0 0 nan\n", "line 1: v: 'nan' is not a number");
  refuses("v 0 0 1e40\n", "'1e40' is not a number");
  refuses(corners + "f 1 2 4\n", "line 4: f: '4' is not one of the 3");
  refuses(corners + "f 0 1 2\n", "'0' is not one of");
  refuses(corners + "f -4 1 2\n", "'-4' is not one of");
  refuses(corners + "f 1 2\n", "2 corners, not in [3");
  refuses(corners + "f 1/1 2/1 3/1\n", "'1' is not one of the 0");
  refuses(corners + "usemtl x\nf 1 2 3\n", "no material library has 'x'");
  EXPECT_THAT(ErrorOf(Write("bad.obj", "mtllib gone.mtl\n")),
              AllOf(HasSubstr("bad.obj, line 1"),
                    HasSubstr("gone.mtl: cannot be opened")));
  EXPECT_THAT(ErrorOf("gone.obj"), HasSubstr("gone.obj: cannot be opened"));
  EXPECT_THAT(ErrorOf("model.fbx"), HasSubstr("ends in .gltf, .glb or .obj"));
}

TEST_F(MeshFileTest, MissingOrBrokenTexturesAreNamed) {
  const std::string path = WriteObj();
  std::filesystem::remove((folder_ / "wall.png"));
  EXPECT_THAT(
      ErrorOf(path),
      AllOf(HasSubstr("wall.obj"), HasSubstr("wall.png: cannot be opened")));
  Write("wall.png", "no image");
  EXPECT_THAT(ErrorOf(path), HasSubstr("is no PNG, JPEG"));
  // A header that asks for gigabytes.
  std::string huge("\x89PNG\r\n\x1a\n\0\0\0\x0dIHDR\0\1\0\0\0\1\0\0", 24);
  Write("wall.png", huge);
  EXPECT_THAT(ErrorOf(path), HasSubstr("65536 x 65536 pixels"));
  WriteTexture("wall.png");
  std::filesystem::resize_file((folder_ / "wall.png"), 40);
  EXPECT_THAT(ErrorOf(path), HasSubstr("broken"));
}

TEST_F(MeshFileTest, LargeTexturesAreHalved) {
  const std::string path = WriteObj();
  MeshFileOptions options;
  options.max_texture_side = 1;
  Scene scene;
  AppendMeshFile(path, "wall", options, &scene);
  EXPECT_EQ(scene.materials[0].texture.size(), cv::Size(1, 1));
}

// ---- glTF ------------------------------------------------------------------

template <typename T>
std::string BytesOf(const std::vector<T>& values) {
  std::string bytes(values.size() * sizeof(T), '\0');
  std::memcpy(bytes.data(), values.data(), bytes.size());
  return bytes;
}

// One triangle (positions, then coordinates, then indices) under a node that
// is moved by (0, 0, 3) and hangs below one that turns +y to +z.
const std::string kGltf = R"({
"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
"nodes": [
 {"children": [1], "rotation": [0.7071067811865475, 0, 0, 0.7071067811865476]},
 {"mesh": 0, "translation": [0, 0, 3]}],
"meshes": [{"primitives": [{"attributes": {"POSITION": 0, "TEXCOORD_0": 1},
  "indices": 2, "material": 0}]}],
"materials": [{"name": "paint", "pbrMetallicRoughness":
  {"baseColorTexture": {"index": 0}, "baseColorFactor": [1, 0.5, 0, 1]}}],
"textures": [{"source": 0}], "images": [{"uri": "a%20wall.png"}],
"buffers": [{"uri": "model.bin", "byteLength": 66}],
"bufferViews": [{"buffer": 0, "byteLength": 60},
 {"buffer": 0, "byteOffset": 60, "byteLength": 6}],
"accessors": [
 {"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"},
 {"bufferView": 0, "byteOffset": 36, "componentType": 5126, "count": 3,
  "type": "VEC2"},
 {"bufferView": 1, "componentType": 5123, "count": 3, "type": "SCALAR"}]})";

std::string GltfBytes(const std::vector<std::uint16_t>& indices = {0, 1, 2}) {
  return BytesOf<float>({0, 0, 0, 1, 0, 0, 0, 2, 0}) +
         BytesOf<float>({0, 0, 1, 0, 0, 1}) + BytesOf(indices);
}

std::string Replaced(std::string text,
                     const std::string& from,
                     const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

TEST_F(MeshFileTest, GltfNodesTexturesAndColours) {
  WriteTexture("a wall.png");
  Write("model.bin", GltfBytes());
  Scene scene;
  const MeshFileReport report =
      AppendMeshFile(Write("model.gltf", kGltf), "model", {}, &scene);
  CheckScene(scene);
  EXPECT_EQ(report.num_triangles, 1);
  // (0, 2, 0) of the mesh: moved to (0, 2, 3), turned to (0, -3, 2); then y up
  // becomes z up: (0, -2, -3).
  EXPECT_TRUE(PlaceOf(scene, 0, 1).isApprox(Eigen::Vector3f(0, -2, -3), 1e-6f));
  // glTF's v goes down like ours: (0, 0) is at the mesh's origin.
  EXPECT_TRUE(PlaceOf(scene, 0, 0).isApprox(Eigen::Vector3f(0, 0, -3), 1e-6f));
  // Red stays; half of the linear green of 200 is 146 (sRGB curve); no blue.
  EXPECT_EQ(scene.materials[0].texture(0, 0), cv::Vec3b(0, 0, 200));
  EXPECT_EQ(scene.materials[0].texture(0, 1), cv::Vec3b(0, 146, 0));
  EXPECT_EQ(scene.materials[0].texture(1, 0), cv::Vec3b(0, 0, 0));
}

TEST_F(MeshFileTest, BinaryGltfWithAnEmbeddedImage) {
  const std::string image_path = WriteTexture("wall.png");
  std::ifstream image_file(image_path, std::ios::binary);
  const std::string image{std::istreambuf_iterator<char>(image_file), {}};
  const std::string bytes = GltfBytes() + image;
  std::string json =
      Replaced(kGltf,
               R"("uri": "model.bin", "byteLength": 66)",
               "\"byteLength\": " + std::to_string(bytes.size()));
  json = Replaced(json, R"("uri": "a%20wall.png")", R"("bufferView": 2)");
  json = Replaced(json,
                  R"("byteOffset": 60, "byteLength": 6})",
                  R"("byteOffset": 60, "byteLength": 6},
                  {"buffer": 0, "byteOffset": 66, "byteLength": )" +
                      std::to_string(image.size()) + "}");
  const auto word = [](std::size_t value) {
    return BytesOf<std::uint32_t>({static_cast<std::uint32_t>(value)});
  };
  const std::string binary = "glTF" + word(2) + word(0) + word(json.size()) +
                             "JSON" + json + word(bytes.size()) +
                             std::string("BIN\0", 4) + bytes;
  Scene scene;
  EXPECT_EQ(AppendMeshFile(Write("model.glb", binary), "model", {}, &scene)
                .num_textures,
            1);
  EXPECT_EQ(scene.materials[0].texture(0, 1), cv::Vec3b(0, 146, 0));
  EXPECT_THAT(ErrorOf(Write("cut.glb", binary.substr(0, 300))),
              HasSubstr("cut off"));
}

TEST_F(MeshFileTest, GltfErrorsNameFileAndEntry) {
  WriteTexture("a wall.png");
  Write("model.bin", GltfBytes());
  const auto refuses = [&](const std::string& from,
                           const std::string& to,
                           const std::string& what) {
    EXPECT_THAT(ErrorOf(Write("bad.gltf", Replaced(kGltf, from, to))),
                AllOf(HasSubstr("bad.gltf"), HasSubstr(what)));
  };
  refuses("\"2.0\"", "\"1.0\"", "version must be 2.x");
  // What makes a file none of these is said before what is wrong within it.
  const std::string without_views =
      Replaced(kGltf, "\"bufferViews\"", "\"noViews\"");
  EXPECT_THAT(
      ErrorOf(Write("bad.gltf",
                    Replaced(without_views,
                             "\"asset\"",
                             "\"extensionsRequired\": "
                             "[\"KHR_draco_mesh_compression\"], \"asset\""))),
      HasSubstr("needs the extension \"KHR_draco_mesh_compression\""));
  EXPECT_THAT(
      ErrorOf(Write("bad.gltf",
                    "{\"asset\": {\"version\": \"1.0\"}, \"accessors\": {}}")),
      HasSubstr("version must be 2.x"));
  refuses("\"scene\": 0", "\"scene\": 1", "scene must be a whole number");
  refuses("\"children\": [1]", "\"children\": [2]", "there are 2 nodes");
  refuses("\"children\": [1]", "\"children\": [0]", "64 nodes in one another");
  refuses("\"mesh\": 0", "\"mesh\": 7", "nodes[1]: mesh");
  refuses("[0, 0, 3]", "[0, 0]", "nodes[1]: translation must be 3 numbers");
  refuses("\"index\": 0", "\"index\": -1", "index must be a whole number");
  refuses("\"byteLength\": 66",
          "\"byteLength\": 67",
          "byteLength is 67, but 66 bytes are there");
  refuses("\"byteOffset\": 60", "\"byteOffset\": 61", "bufferViews[1]");
  refuses("\"byteOffset\": 36", "\"byteOffset\": 40", "accessors[1]");
  refuses("\"VEC2\"", "\"VEC9\"", "accessors[1]: unknown type");
  refuses("5123", "5122", "indices must be SCALAR of unsigned");
  refuses("\"count\": 3, \"type\": \"SCALAR\"",
          "\"count\": 2, \"type\": \"SCALAR\"",
          "2 corners are no whole number");
  refuses("\"material\": 0", "\"mode\": 5", "strips and fans");
  refuses("model.bin", "gone.bin", "gone.bin: cannot be opened");
  refuses("\"asset\"", "asset", "not JSON at byte");
  Write("model.bin", GltfBytes({0, 1, 3}));
  refuses("\"scene\": 0", "\"scene\": 0", "index 3, but there are 3 vertices");
}

TEST_F(MeshFileTest, RefusesNumbersThatAreNone) {
  const auto refuses = [&](std::size_t at, const std::string& what) {
    std::string bytes = GltfBytes();
    bytes.replace(at, 4, BytesOf<float>({std::nanf("")}));
    Write("model.bin", bytes);
    WriteTexture("a wall.png");
    EXPECT_THAT(ErrorOf(Write("bad.gltf", kGltf)), HasSubstr(what));
  };
  refuses(4, "a vertex is not finite");
  refuses(40, "a texture coordinate is not in");
}

TEST_F(MeshFileTest, RefusesAModelTooLarge) {
  MeshFileOptions options;
  options.scale = 1000.0;
  EXPECT_THAT(ErrorOf(WriteObj(), options), HasSubstr("more than 200 m"));
  options.scale = 1.0;
  options.X_WM.translation() << 0.0, -200.0, 0.0;
  EXPECT_EQ(ErrorOf(WriteObj(), options), "none");
  options.X_WM.translation() << 0.0, -200.5, 0.0;
  EXPECT_THAT(ErrorOf(WriteObj(), options), HasSubstr("reaches 200.5"));
  options.scale = 0.0;
  Scene scene;
  EXPECT_THROW(AppendMeshFile(WriteObj(), "wall", options, &scene),
               std::invalid_argument);
}

// An artist's room with its light in the textures; feet and inches of its own.
TEST(MeshFileRealDataTest, VanGoghRoom) {
  const std::string folder = RealDataFolder("van_gogh_room_gltf");
  if (folder.empty()) GTEST_SKIP() << "no real recordings";
  Scene scene;
  MeshFileOptions options;
  options.has_baked_light = true;
  options.max_texture_side = 1024;
  const MeshFileReport report =
      AppendMeshFile(folder + "/scene.gltf", "room", options, &scene);
  CheckScene(scene);
  EXPECT_EQ(report.num_triangles, 11272);
  EXPECT_EQ(report.num_textures, 15);
  EXPECT_EQ(report.num_materials, 15);
  const Eigen::Vector3d size = report.box_W.sizes();
  RecordProperty("size",
                 std::to_string(size.x()) + " x " + std::to_string(size.y()) +
                     " x " + std::to_string(size.z()));
  // Upright: the room is about as high as it is wide, and longer.
  EXPECT_GT(size.minCoeff(), 0.0);
  for (const SceneMaterial& material : scene.materials) {
    EXPECT_TRUE(material.is_emissive);
    EXPECT_LE(material.texture.cols, 1024);
  }
}

}  // namespace
}  // namespace waymark
