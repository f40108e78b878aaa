#include "drivers/simulator/light_cell.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace waymark {
namespace {

// Parts between whose corners light changes by less than this are not divided
// further, nor those where the last division found it as straight as that: the
// errors left are a fraction of a step of an image of 8 bits.
constexpr float kSmoothChange = 0.08f;
constexpr float kSmoothBend = 0.03f;
constexpr float kLeastChange = 0.004f;

std::size_t GridIndex(int x, int y, int num_columns) {
  return static_cast<std::size_t>(y) * static_cast<std::size_t>(num_columns) +
         static_cast<std::size_t>(x);
}

class Filler {
 public:
  Filler(int steps, const LightCellSource& source, std::span<LightNode> nodes)
      : steps_(steps),
        source_(source),
        nodes_(nodes),
        states_(nodes.size(), State::kOpen) {}

  void Run() {
    for (const LightNodePlace& corner : Corners({0, 0}, steps_)) {
      states_[Index(corner)] = State::kFixed;
    }
    if (steps_ == 1) return;
    const auto corners = Corners({0, 0}, steps_);
    for (const auto& [a, b] : {std::pair{0, 1}, {0, 2}, {1, 3}, {2, 3}}) {
      DivideEdge(corners[static_cast<std::size_t>(a)],
                 corners[static_cast<std::size_t>(b)],
                 steps_,
                 true);
    }
    DivideSquare({0, 0}, steps_, true);
  }

 private:
  enum class State : std::uint8_t { kOpen, kInterpolated, kFixed };

  [[nodiscard]] std::size_t Index(const LightNodePlace& at) const {
    return GridIndex(at.x, at.y, steps_ + 1);
  }
  static std::array<LightNodePlace, 4> Corners(const LightNodePlace& at,
                                               int size) {
    return {at,
            {at.x + size, at.y},
            {at.x, at.y + size},
            {at.x + size, at.y + size}};
  }

  void Compute(const LightNodePlace& at) {
    if (states_[Index(at)] == State::kFixed) return;
    nodes_[Index(at)] = source_.compute(at);
    states_[Index(at)] = State::kFixed;
  }

  // Whether light between these nodes may be other than straight. `is_bent`:
  // that about them is.
  [[nodiscard]] bool Differ(std::span<const LightNodePlace> places,
                            bool is_bent) const {
    int num_buried = 0;
    float low = 1e30f;
    float high = 0.0f;
    for (const LightNodePlace& at : places) {
      const LightNode& node = nodes_[Index(at)];
      num_buried += node.is_buried ? 1 : 0;
      low = std::min(low, Largest(node.light));
      high = std::max(high, Largest(node.light));
    }
    if (num_buried == static_cast<int>(places.size())) return false;
    return num_buried > 0 ||
           (is_bent && high - low > kSmoothChange * high + kLeastChange) ||
           source_.are_apart(places);
  }

  // Whether a node's light is not what its neighbours on both sides let expect.
  [[nodiscard]] bool IsBent(const LightNodePlace& a,
                            const LightNodePlace& b) const {
    const LightNode& middle = nodes_[Index({(a.x + b.x) / 2, (a.y + b.y) / 2})];
    const Float4 straight =
        Mix(nodes_[Index(a)].light, nodes_[Index(b)].light, 0.5f);
    const Float4 off = middle.light - straight;
    return std::max(Largest(off), Largest(-off)) >
           kSmoothBend * Largest(straight) + kLeastChange;
  }

  void Interpolate(const LightNodePlace& at,
                   const LightNode& a,
                   const LightNode& b,
                   float share,
                   State state) {
    if (states_[Index(at)] == State::kFixed) return;
    LightNode& node = nodes_[Index(at)];
    node.direct = Mix(a.direct, b.direct, share);
    node.light = Mix(a.light, b.light, share);
    // Of a part wholly inside something, or wholly outside.
    node.is_buried = a.is_buried;
    states_[Index(at)] = state;
  }

  // A border of the cell, or a part of one: `length` steps from a to b.
  void DivideEdge(const LightNodePlace& a,
                  const LightNodePlace& b,
                  int length,
                  bool is_bent) {
    if (length == 1) return;
    const std::array<LightNodePlace, 2> ends = {a, b};
    const int step_x = (b.x - a.x) / length;
    const int step_y = (b.y - a.y) / length;
    if (length < steps_ && !Differ(ends, is_bent)) {
      for (int i = 1; i < length; ++i) {
        Interpolate({a.x + i * step_x, a.y + i * step_y},
                    nodes_[Index(a)],
                    nodes_[Index(b)],
                    static_cast<float>(i) / static_cast<float>(length),
                    State::kFixed);
      }
      return;
    }
    const int half = length / 2;
    const LightNodePlace middle = {a.x + half * step_x, a.y + half * step_y};
    Compute(middle);
    const bool is_middle_bent = IsBent(a, b);
    DivideEdge(a, middle, half, is_middle_bent);
    DivideEdge(middle, b, half, is_middle_bent);
  }

  void DivideSquare(const LightNodePlace& at, int size, bool is_bent) {
    if (size == 1) return;
    if (size < steps_ && !Differ(Corners(at, size), is_bent)) {
      FillSquare(at, size);
      return;
    }
    const int half = size / 2;
    Compute({at.x + half, at.y});
    Compute({at.x, at.y + half});
    Compute({at.x + half, at.y + half});
    Compute({at.x + size, at.y + half});
    Compute({at.x + half, at.y + size});
    const auto corners = Corners(at, size);
    const bool is_any_bent =
        IsBent(corners[0], corners[1]) || IsBent(corners[0], corners[2]) ||
        IsBent(corners[1], corners[3]) || IsBent(corners[2], corners[3]) ||
        IsBent(corners[0], corners[3]) || IsBent(corners[1], corners[2]);
    for (const LightNodePlace& part : Corners(at, half)) {
      DivideSquare(part, half, is_any_bent);
    }
  }

  void FillSquare(const LightNodePlace& at, int size) {
    const auto corners = Corners(at, size);
    for (int j = 0; j <= size; ++j) {
      const float down = static_cast<float>(j) / static_cast<float>(size);
      LightNode left = nodes_[Index(corners[0])];
      LightNode right = nodes_[Index(corners[1])];
      const LightNode& lower_left = nodes_[Index(corners[2])];
      const LightNode& lower_right = nodes_[Index(corners[3])];
      left.direct = Mix(left.direct, lower_left.direct, down);
      left.light = Mix(left.light, lower_left.light, down);
      right.direct = Mix(right.direct, lower_right.direct, down);
      right.light = Mix(right.light, lower_right.light, down);
      for (int i = 0; i <= size; ++i) {
        // A finer part beside this one may compute it later.
        Interpolate({at.x + i, at.y + j},
                    left,
                    right,
                    static_cast<float>(i) / static_cast<float>(size),
                    State::kInterpolated);
      }
    }
  }

  int steps_;
  const LightCellSource& source_;
  std::span<LightNode> nodes_;
  std::vector<State> states_;
};

void Unbury(int num, std::span<LightNode> nodes) {
  for (int round = 0; round < num; ++round) {
    std::vector<std::pair<std::size_t, Float4>> found;
    for (int y = 0; y < num; ++y) {
      for (int x = 0; x < num; ++x) {
        const auto here = GridIndex(x, y, num);
        if (!nodes[here].is_buried) continue;
        Float4 sum{};
        float count = 0.0f;
        for (int j = std::max(0, y - 1); j <= std::min(num - 1, y + 1); ++j) {
          for (int i = std::max(0, x - 1); i <= std::min(num - 1, x + 1); ++i) {
            const LightNode& other = nodes[GridIndex(i, j, num)];
            if (other.is_buried) continue;
            sum += other.light;
            count += 1.0f;
          }
        }
        if (count > 0.0f) found.emplace_back(here, sum / Broadcast(count));
      }
    }
    if (found.empty()) return;
    for (const auto& [index, light] : found) {
      nodes[index].light = light;
      nodes[index].is_buried = false;
    }
  }
}

}  // namespace

void FillLightCell(int steps,
                   const LightCellSource& source,
                   std::span<LightNode> nodes) {
  Filler(steps, source, nodes).Run();
  Unbury(steps + 1, nodes);
}

}  // namespace waymark
