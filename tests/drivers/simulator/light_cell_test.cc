#include "drivers/simulator/light_cell.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <vector>

namespace waymark {
namespace {

constexpr int kSteps = 8;

// A cell at [left, left + 1] x [0, 1] of a plane with given light and given
// places inside something.
struct Cell {
  std::function<float(double, double)> light;
  std::function<bool(double, double)> is_buried = [](double, double) {
    return false;
  };
  std::function<bool(std::span<const LightNodePlace>)> are_apart =
      [](std::span<const LightNodePlace>) { return false; };
  double left = 0.0;

  int num_computed = 0;
  std::vector<LightNode> nodes{};

  LightNode Compute(const LightNodePlace& at) {
    const double x = left + static_cast<double>(at.x) / kSteps;
    const double y = static_cast<double>(at.y) / kSteps;
    LightNode node;
    node.is_buried = is_buried(x, y);
    node.light = Broadcast(node.is_buried ? 0.0f : light(x, y));
    return node;
  }
  void Fill() {
    nodes.assign((kSteps + 1) * (kSteps + 1), {});
    for (const int y : {0, kSteps}) {
      for (const int x : {0, kSteps}) At(x, y) = Compute({x, y});
    }
    const LightCellSource source{[this](const LightNodePlace& at) {
                                   ++num_computed;
                                   return Compute(at);
                                 },
                                 are_apart};
    FillLightCell(kSteps, source, nodes);
  }
  LightNode& At(int x, int y) {
    return nodes[static_cast<std::size_t>(y * (kSteps + 1) + x)];
  }
  float LargestError() {
    float largest = 0.0f;
    for (int y = 0; y <= kSteps; ++y) {
      for (int x = 0; x <= kSteps; ++x) {
        largest = std::max(
            largest, std::abs(At(x, y).light[1] - Compute({x, y}).light[1]));
      }
    }
    return largest;
  }
};

TEST(LightCell, StraightLightIsDividedOnceAndExact) {
  Cell cell{[](double x, double y) {
    return static_cast<float>(0.2 + 0.5 * x + 0.1 * y);
  }};
  cell.Fill();
  EXPECT_EQ(cell.num_computed, 5);
  EXPECT_LT(cell.LargestError(), 1e-6f);
}

TEST(LightCell, CurvedLightIsWithinTwoHundredths) {
  Cell cell{[](double x, double y) {
    return static_cast<float>(std::exp(-6.0 * x) + 0.3 * y * y);
  }};
  cell.Fill();
  EXPECT_LT(cell.LargestError(), 0.02f);
  EXPECT_LT(cell.num_computed, 77);
}

// The border of a shadow: every node about it is computed.
TEST(LightCell, ABorderOfAShadowIsWhereItIs) {
  for (const double at : {0.07, 0.3, 0.55, 0.9}) {
    Cell cell{
        [&](double x, double y) { return x + 0.3 * y < at ? 1.0f : 0.1f; }};
    cell.Fill();
    EXPECT_EQ(cell.LargestError(), 0.0f) << at;
    EXPECT_LT(cell.num_computed, 77) << at;
  }
}

TEST(LightCell, WhatStandsBetweenNodesIsLookedAt) {
  // A thin wall at x = 0.31 with a dark foot that the corners do not see.
  constexpr double kWall = 0.31;
  Cell cell{[&](double x, double) {
    return std::abs(x - kWall) < 0.1 ? 0.2f : 1.0f;
  }};
  cell.are_apart = [&](std::span<const LightNodePlace> places) {
    bool is_left = false;
    bool is_right = false;
    for (const LightNodePlace& at : places) {
      (static_cast<double>(at.x) / kSteps < kWall ? is_left : is_right) = true;
    }
    return is_left && is_right;
  };
  cell.Fill();
  EXPECT_EQ(cell.LargestError(), 0.0f);
}

// Cells side by side hold the same light on their common border, whatever is
// on their other sides.
TEST(LightCell, CellsAgreeOnTheirBorder) {
  const auto light = [](double x, double y) {
    return static_cast<float>(1.0 + std::sin(5.0 * x) * y +
                              (x > 1.2 && y > 0.6 ? 2.0 : 0.0) +
                              (x < 0.4 && y < 0.3 ? 1.0 : 0.0));
  };
  Cell left{light};
  Cell right{light};
  right.left = 1.0;
  left.Fill();
  right.Fill();
  for (int y = 0; y <= kSteps; ++y) {
    EXPECT_EQ(left.At(kSteps, y).light[1], right.At(0, y).light[1]) << y;
  }
}

TEST(LightCell, BuriedNodesTakeTheLightBesideThem) {
  Cell cell{[](double, double) { return 0.7f; }};
  cell.is_buried = [](double x, double) { return x > 0.4; };
  cell.Fill();
  for (const LightNode& node : cell.nodes) {
    EXPECT_FLOAT_EQ(node.light[1], 0.7f);
    EXPECT_FALSE(node.is_buried);
  }
}

}  // namespace
}  // namespace waymark
