// What the segmented Hough transform and the merging do with many values at a
// time, against the plain way.
#include "estimation/base/random.h"
#include "estimation/lines/near_pieces.h"
#include "estimation/lines/tile_groups.h"
#include "estimation/lines/tile_order.h"
#include "estimation/lines/tile_words.h"

#include <gtest/gtest.h>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <set>
#include <utility>
#include <vector>

namespace waymark {
namespace {

using Word = std::uint64_t;

Word DrawTile(double density, Random* random) {
  Word word = 0;
  for (int i = 0; i < 64; ++i) {
    word = word << 1 | (random->Uniform() < density ? 1 : 0);
  }
  return word;
}

bool IsSet(Word tile, int x, int y) {
  return (tile >> (8 * y + x) & 1) != 0;
}

TEST(TileWords, RowsBecomeTilesSideBySide) {
  Random random(1);
  std::array<Word, kTileSide> rows{};
  for (Word& row : rows) row = DrawTile(0.5, &random);
  const std::array<Word, kTileSide> tiles = TilesOf(rows);
  for (int x = 0; x < 64; ++x) {
    for (int y = 0; y < kTileSide; ++y) {
      EXPECT_EQ(IsSet(tiles[static_cast<std::size_t>(x / kTileSide)], x % 8, y),
                (rows[static_cast<std::size_t>(y)] >> x & 1) != 0);
    }
  }
}

TEST(TileWords, TransposingSwapsXAndY) {
  Random random(2);
  const Word tile = DrawTile(0.4, &random);
  const Word transposed = TransposeTile(tile);
  for (int y = 0; y < 8; ++y) {
    for (int x = 0; x < 8; ++x) {
      EXPECT_EQ(IsSet(transposed, x, y), IsSet(tile, y, x));
    }
  }
}

std::vector<Word> GroupsByOpenCv(Word tile) {
  cv::Mat1b map(8, 8);
  for (int i = 0; i < 64; ++i) map(i / 8, i % 8) = (tile >> i & 1) ? 255 : 0;
  cv::Mat1i labels;
  const int num = cv::connectedComponents(map, labels, 8);
  std::vector<Word> groups(static_cast<std::size_t>(num));
  for (int i = 0; i < 64; ++i) {
    groups[static_cast<std::size_t>(labels(i / 8, i % 8))] |= Word{1} << i;
  }
  groups.erase(groups.begin());  // The background.
  std::sort(groups.begin(), groups.end(), [](Word a, Word b) {
    return std::countr_zero(a) < std::countr_zero(b);
  });
  return groups;
}

// Among them the longest way through a tile and the most groups of one.
TEST(TileGroups, AreTheConnectedComponents) {
  constexpr Word kSerpentine = 0xFF01FF80FF01FF80ull;
  constexpr Word kMost = 0x0055005500550055ull;
  Random random(3);
  for (int round = 0; round < 300; ++round) {
    std::array<Word, kTileBlock> tiles{};
    for (Word& tile : tiles) tile = DrawTile(0.05 + 0.001 * round, &random);
    tiles[2] = kSerpentine;
    tiles[3] = kMost;
    tiles[5] = 0;
    tiles[6] = ~Word{0};
    for (const FindTileGroups find : FindTileGroupsVariants()) {
      TileGroups groups;
      find(tiles, &groups);
      for (std::size_t k = 0; k < tiles.size(); ++k) {
        const std::vector<Word> expected = GroupsByOpenCv(tiles[k]);
        for (std::size_t i = 0; i < expected.size(); ++i) {
          ASSERT_EQ(groups.of_rank[i][k], expected[i]);
        }
        EXPECT_EQ(groups.of_rank[expected.size()][k], 0u);
      }
    }
  }
}

// In the order in which the direction passes them, nearly: columns and rows
// are listed whole.
TEST(TileOrder, ListsAllPixelsAlongTheDirection) {
  Random random(4);
  for (int degrees = 0; degrees < 360; degrees += 15) {
    const double angle = degrees * std::acos(-1.0) / 180.0;
    const Eigen::Vector2f d(static_cast<float>(std::cos(angle)),
                            static_cast<float>(std::sin(angle)));
    const TilePixels tile{DrawTile(0.4, &random), 40, 24};
    const int num = std::popcount(tile.bits);
    const TileOrder order(d);
    std::vector<Eigen::Vector2f> pixels;
    for (const ListTilePixels list : ListTilePixelsVariants()) {
      std::vector<Eigen::Vector2f> listed(
          static_cast<std::size_t>(num + kMostListed));
      EXPECT_EQ(order.List(tile, num, list, listed.data()),
                listed.data() + num);
      listed.resize(static_cast<std::size_t>(num));
      if (pixels.empty()) pixels = listed;
      EXPECT_EQ(listed, pixels);
    }
    ASSERT_EQ(pixels.size(), static_cast<std::size_t>(num));
    std::set<std::pair<int, int>> seen;
    const bool is_wide = std::abs(d.x()) >= std::abs(d.y());
    for (std::size_t i = 0; i < pixels.size(); ++i) {
      const int x = static_cast<int>(pixels[i].x()) - tile.x;
      const int y = static_cast<int>(pixels[i].y()) - tile.y;
      EXPECT_TRUE(IsSet(tile.bits, x, y));
      EXPECT_TRUE(seen.emplace(x, y).second);
      if (i == 0) continue;
      const Eigen::Vector2f step = pixels[i] - pixels[i - 1];
      const float major = is_wide ? step.x() * d.x() : step.y() * d.y();
      const float minor = is_wide ? step.y() * d.y() : step.x() * d.x();
      EXPECT_TRUE(major > 0.0f || (major == 0.0f && minor >= 0.0f)) << degrees;
    }
  }
}

// Of one piece, by the words of the header.
bool IsNear(const LineEnd& line,
            const Eigen::Vector2f& near,
            const Eigen::Vector2f& far) {
  const auto along = [&](const Eigen::Vector2f& p) {
    return line.dx * (p.x() - line.x) + line.dy * (p.y() - line.y);
  };
  const auto across = [&](const Eigen::Vector2f& p) {
    return std::abs(line.dx * (p.y() - line.y) - line.dy * (p.x() - line.x));
  };
  return across(near) <= line.aside && along(near) >= line.least_step &&
         along(near) <= line.most_step && along(far) > 0.0f &&
         along(far) > along(near) &&
         across(far) <= line.aside + line.turn * along(far);
}

TEST(NearPieces, AreTheSameOnAnyProcessor) {
  Random random(5);
  std::int64_t num_found = 0;
  for (int round = 0; round < 2000; ++round) {
    // Three rows of three cells, in some rounds crowded ones.
    std::vector<std::int32_t> first{0};
    for (int cell = 0; cell < 9; ++cell) {
      const int most = round % 10 == 0 ? 20 : 4;
      first.push_back(first.back() +
                      static_cast<std::int32_t>(random.Uniform() * most));
    }
    const auto num = static_cast<std::size_t>(first.back());
    std::array<std::vector<float>, 4> ends;  // Of ax, ay, bx, by.
    for (std::vector<float>& values : ends) {
      values.resize(num + kPieceLanes);
      for (std::size_t i = 0; i < num; ++i) {
        values[i] = static_cast<float>(std::floor(24.0 * random.Uniform()));
      }
    }
    for (std::size_t i = 0; i < num; i += 7) {
      ends[0][i] = std::numeric_limits<float>::quiet_NaN();
    }
    const double angle = 6.28 * random.Uniform();
    const LineEnd line{12.0f,
                       11.0f,
                       static_cast<float>(std::cos(angle)),
                       static_cast<float>(std::sin(angle)),
                       -2.0f,
                       6.0f,
                       2.0f,
                       0.35f};
    const PieceEnds pieces{
        ends[0].data(), ends[1].data(), ends[2].data(), ends[3].data()};
    // Cells 1 and 2 of each row.
    const PieceRows rows{first.data() + 1, 3, 2, 3};
    std::vector<std::int32_t> expected;
    for (std::size_t row = 0; row < 3; ++row) {
      const auto begin = static_cast<std::size_t>(first[3 * row + 1]);
      const auto end = static_cast<std::size_t>(first[3 * row + 3]);
      for (std::size_t i = begin; i < end; ++i) {
        const Eigen::Vector2f a(ends[0][i], ends[1][i]);
        const Eigen::Vector2f b(ends[2][i], ends[3][i]);
        const auto code = 2 * static_cast<std::int32_t>(i);
        if (IsNear(line, a, b)) expected.push_back(code);
        if (IsNear(line, b, a)) expected.push_back(code + 1);
      }
    }
    for (const FindNearPieces find : FindNearPiecesVariants()) {
      std::vector<std::int32_t> found(num);
      found.resize(static_cast<std::size_t>(
          find(pieces, rows, line, found.data()) - found.data()));
      ASSERT_EQ(found, expected);
    }
    num_found += static_cast<std::int64_t>(expected.size());
  }
  EXPECT_GT(num_found, 300);
}

}  // namespace
}  // namespace waymark
