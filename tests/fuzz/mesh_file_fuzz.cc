// Mesh files: what is taken is a sound scene, what is not is refused before
// Assimp, which trusts its input, reads it.
#include "drivers/simulator/mesh_file.h"
#include "tests/fuzz/fuzz_target.h"

#include <algorithm>
#include <cstring>

namespace waymark::fuzz {
namespace {

// Deeper or longer ones only cost time.
constexpr std::size_t kMaxBytes = 100'000;

void AppendAndCheck(const std::string& path) {
  Scene scene;
  const bool taken = TakesOrRefuses([&] {
    const MeshFileReport report = AppendMeshFile(path, "model", {}, &scene);
    Expect(report.num_triangles > 0 && !report.box_W.isEmpty(),
           "what is taken has triangles");
  });
  if (!taken) {
    Expect(scene.materials.empty() && scene.surfaces.empty() &&
               scene.mesh.positions.empty(),
           "a scene is not changed by what is refused");
    return;
  }
  CheckScene(scene);
}

std::string Floats(const std::vector<float>& values) {
  std::string bytes(values.size() * sizeof(float), '\0');
  std::memcpy(bytes.data(), values.data(), bytes.size());
  return bytes;
}

}  // namespace

// The first byte says which: OBJ and its materials, glTF and its buffer (each
// two parts), or binary glTF.
void RunOne(Bytes data) {
  if (data.empty() || data.size() > kMaxBytes) return;
  const Bytes content = data.subspan(1);
  if (data[0] == 'b') {
    AppendAndCheck(WriteScratch("model.glb", content));
    return;
  }
  // A buffer may hold the byte that separates parts: only the first counts.
  const auto end = std::find(content.begin(), content.end(), 0xFF);
  const auto length = static_cast<std::size_t>(end - content.begin());
  const Bytes first = content.first(length);
  const Bytes second = content.subspan(std::min(length + 1, content.size()));
  if (data[0] == 'o') {
    WriteScratch("model.mtl", second);
    AppendAndCheck(WriteScratch("model.obj", first));
  } else {
    WriteScratch("model.bin", second);
    AppendAndCheck(WriteScratch("model.gltf", first));
  }
}

std::vector<std::string> Seeds() {
  const std::string obj =
      "mtllib model.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0.5\nv 0 1 0\n"
      "vt 0 0\nvt 1 0\nvt 1 1\nusemtl red\nf 1/1 2/2 3/3\nf 1 2 3 4\n"
      "f -1//1 -2//2 -3//3\n\xFFnewmtl red\nKd 1 0.5 0\n";
  const std::string json = R"({"asset":{"version":"2.0"},"scene":0,
"scenes":[{"nodes":[0]}],"nodes":[{"children":[1],"scale":[2,1,1]},
{"mesh":0,"matrix":[1,0,0,0,0,1,0,0,0,0,1,0,0,0,3,1]}],
"meshes":[{"primitives":[{"attributes":{"POSITION":0,"TEXCOORD_0":1},
"indices":2,"material":0}]}],"materials":[{"pbrMetallicRoughness":
{"baseColorFactor":[1,0.5,0,1]}}],"buffers":[{"uri":"model.bin",
"byteLength":66}],"bufferViews":[{"buffer":0,"byteLength":60},
{"buffer":0,"byteOffset":60,"byteLength":6}],"accessors":[
{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"},
{"bufferView":0,"byteOffset":36,"componentType":5126,"count":3,
"type":"VEC2"},{"bufferView":1,"componentType":5123,"count":3,
"type":"SCALAR"}]})";
  const std::string buffer = Floats({0, 0, 0, 1, 0, 0, 0, 2, 0}) +
                             Floats({0, 0, 1, 0, 0, 1}) +
                             std::string("\0\0\1\0\2\0", 6);
  const auto word = [](std::size_t value) {
    std::string bytes;
    for (unsigned shift = 0; shift < 32; shift += 8) {
      bytes += static_cast<char>((value >> shift) & 0xFFU);
    }
    return bytes;
  };
  std::string inside = json;
  inside.erase(inside.find("\"uri\":\"model.bin\","), 18);
  return {"o" + obj,
          "g" + json + "\xFF" + buffer,
          "bglTF" + word(2) + word(0) + word(inside.size()) + "JSON" + inside +
              word(buffer.size()) + std::string("BIN\0", 4) + buffer};
}

}  // namespace waymark::fuzz
