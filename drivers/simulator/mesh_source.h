// Mesh files, checked and cut down to what is used of them, before a library
// that trusts its input reads them.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace waymark {

struct MeshSource {
  // Files by name; `main` is the one to begin with. Written anew from what was
  // read: nothing of the originals that was not understood is in them.
  std::string main;
  std::map<std::string, std::string> files;
  // Textures: the files above call entry i of this list "image<i>".
  struct Image {
    std::string name;   // For errors.
    std::string path;   // Of a file; empty where embedded.
    std::string bytes;  // Where embedded.
  };
  std::vector<Image> images;
  bool has_linear_colors = false;  // Material colours are linear, not sRGB.
};

// The name that MeshSource gives to a texture.
[[nodiscard]] std::string MeshImageName(std::size_t index);

// Both read `path` and the files it names (not the textures). They throw
// InputError naming file and place where something is missing, broken or out
// of range.

// glTF 2.0, as text (.gltf) or binary (.glb): nodes, triangles, first texture
// coordinates, base colours. Refuses sparse and compressed accessors.
[[nodiscard]] MeshSource ReadGltfSource(const std::string& path);
// Wavefront OBJ with its material libraries: v, vt, f, usemtl, mtllib; Kd,
// map_Kd.
[[nodiscard]] MeshSource ReadObjSource(const std::string& path);

}  // namespace waymark
