// The nodes of light inside one cell of a light map.
#pragma once

#include "drivers/simulator/simd.h"

#include <cstdint>
#include <functional>
#include <span>

namespace waymark {

struct LightNode {
  Float4 direct{};
  Float4 light{};
  std::uint64_t lamps = 0;  // LightField::LampSet that give light there.
  // Inside something solid, where no light comes.
  bool is_buried = false;
  bool is_used = false;
};

// A node's place in its cell: 0 to `steps` each way.
struct LightNodePlace {
  int x = 0;
  int y = 0;
};

struct LightCellSource {
  std::function<LightNode(LightNodePlace)> compute;
  // Whether something stands between two to four nodes.
  std::function<bool(std::span<const LightNodePlace>)> are_apart;
};

// Fills the (steps + 1)^2 nodes of a cell, row by row, from its four corners.
// `steps`: a power of two. Halves the cell, and its parts again where the light
// at their corners differs or something stands between them; elsewhere light is
// interpolated. The nodes of a border depend on that border alone, so that
// cells side by side agree.
//
// Nodes inside solid things take the mean of their neighbours outside, ring
// after ring, so that their darkness does not shine out.
void FillLightCell(int steps,
                   const LightCellSource& source,
                   std::span<LightNode> nodes);

}  // namespace waymark
