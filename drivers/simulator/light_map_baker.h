// Computes a LightMap; used by it alone.
#pragma once

#include "drivers/simulator/light_cell.h"
#include "drivers/simulator/light_map.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace waymark {

// In four passes over rows of nodes or cells, each of which reads only what
// passes before it wrote: direct light at the corners of all cells; what
// arrives otherwise, with the first pass' light thrown back; how fine each cell
// must be; and the nodes inside finer cells.
class LightMapBaker {
 public:
  LightMapBaker(const Scene& scene,
                const LightField& field,
                std::span<const Float4> albedos,
                int num_threads,
                LightMap* map);

  void Bake();

 private:
  // A row of a chart.
  struct Row {
    std::size_t chart = 0;
    int y = 0;
  };
  static constexpr int kMostSteps = 8;
  static constexpr std::size_t kMostNodes = (kMostSteps + 1) * (kMostSteps + 1);

  [[nodiscard]] std::size_t NodeIndex(std::size_t chart,
                                      int side,
                                      int x,
                                      int y) const;
  [[nodiscard]] std::size_t CellIndex(std::size_t chart,
                                      int side,
                                      int x,
                                      int y) const;
  [[nodiscard]] Eigen::Vector3d CornerPoint(const LightChart& chart,
                                            int x,
                                            int y) const;
  [[nodiscard]] std::vector<std::uint32_t> TrianglesAt(const LightChart& chart,
                                                       int x,
                                                       int y) const;
  [[nodiscard]] Float4 ThrownBack(std::uint32_t triangle,
                                  const Eigen::Vector3f& p_W,
                                  const Eigen::Vector3f& direction) const;
  // `node->direct` is there already.
  void Light(const Eigen::Vector3d& p_W,
             const Eigen::Vector3d& n_W,
             LightNode* node) const;

  void Layout();
  void DirectRow(const Row& row);
  void GatherRow(const Row& row);
  void ChooseStepsRow(const Row& row);
  [[nodiscard]] int StepsOf(std::size_t chart, int side, int x, int y) const;
  void AssignNodes();
  void FillRow(const Row& row);
  [[nodiscard]] LightField::LampSet LampsAbout(std::size_t chart,
                                               int side,
                                               int x,
                                               int y) const;
  void FillCell(std::size_t chart, int side, int x, int y);
  void MendEdgesRow(const Row& row);
  void MendEdges(std::size_t chart, int side, int x, int y);

  const Scene& scene_;
  const LightField& field_;
  std::span<const Float4> albedos_;
  int num_threads_;
  LightMap* map_;
  std::vector<Row> node_rows_;
  std::vector<Row> cell_rows_;
  std::vector<std::size_t> first_node_;  // By chart; the back follows.
  std::vector<LightNode> nodes_;
  std::vector<std::uint8_t> log_steps_;  // By cell; 255: not of the surface.
};

}  // namespace waymark
