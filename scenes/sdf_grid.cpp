#include "scenes/sdf_grid.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <unordered_map>

#include "scenes/volume_file.h"

namespace penumbra {
namespace {

constexpr int kMostPoints = 2048;  ///< along an edge

/// Interpolates the values between grid points. Positions are in cells.
class Field {
 public:
  explicit Field(const SdfGrid& grid) : grid_(grid) {}

  [[nodiscard]] double at(const glm::dvec3& place) const {
    std::array<int, 3> cell{};
    glm::dvec3 f;
    for (int axis = 0; axis < 3; ++axis) {
      const int last = grid_.size[std::size_t(axis)] - 1;
      const double x = std::clamp(place[axis], 0.0, double(last));
      cell[std::size_t(axis)] = std::min(int(x), last - 1);
      f[axis] = x - cell[std::size_t(axis)];
    }
    double sum = 0;
    for (int corner = 0; corner < 8; ++corner) {
      const int x = corner & 1, y = corner >> 1 & 1, z = corner >> 2;
      sum += (x ? f.x : 1 - f.x) * (y ? f.y : 1 - f.y) * (z ? f.z : 1 - f.z) *
             point(cell[0] + x, cell[1] + y, cell[2] + z);
    }
    return sum;
  }

  [[nodiscard]] double point(int x, int y, int z) const {
    return double(grid_.values[(std::size_t(z) * std::size_t(grid_.size[1]) + std::size_t(y)) *
                                   std::size_t(grid_.size[0]) +
                               std::size_t(x)]);
  }

  /// Central difference over one cell, per unit of the cube.
  [[nodiscard]] glm::dvec3 gradient(const glm::dvec3& place) const {
    glm::dvec3 result;
    for (int axis = 0; axis < 3; ++axis) {
      const double cells = grid_.size[std::size_t(axis)] - 1;
      glm::dvec3 low = place, high = place;
      low[axis] = std::max(place[axis] - 0.5, 0.0), high[axis] = std::min(place[axis] + 0.5, cells);
      result[axis] = (at(high) - at(low)) / (high[axis] - low[axis]) * cells;
    }
    return result;
  }

  /// Whether the surface may pass through the cell. The trilinear interpolation stays within the values at
  /// the cell's corners.
  [[nodiscard]] bool crosses(int x, int y, int z) const {
    bool inside = false, outside = false;
    for (int corner = 0; corner < 8; ++corner)
      (point(x + (corner & 1), y + (corner >> 1 & 1), z + (corner >> 2)) < 0 ? inside : outside) = true;
    return inside && outside;
  }

 private:
  const SdfGrid& grid_;
};

/// Marching tetrahedra on the finer cells. Each cell is divided into six tetrahedra around its diagonal, in
/// the same way for all cells, so that neighbours match (Kuhn 1960).
class Mesher {
 public:
  Mesher(const SdfGrid& grid, int pieces) : grid_(grid), field_(grid), pieces_(pieces) {}

  Mesh mesh() {
    for (int z = 0; z + 1 < grid_.size[2]; ++z)
      for (int y = 0; y + 1 < grid_.size[1]; ++y)
        for (int x = 0; x + 1 < grid_.size[0]; ++x)
          if (field_.crosses(x, y, z)) add_cell({x, y, z});
    mesh_.texcoords.assign(mesh_.positions.size(), glm::vec2(0));
    return std::move(mesh_);
  }

 private:
  void add_cell(const glm::ivec3& cell) {
    for (int z = 0; z < pieces_; ++z)
      for (int y = 0; y < pieces_; ++y)
        for (int x = 0; x < pieces_; ++x) {
          const glm::ivec3 from = cell * pieces_ + glm::ivec3(x, y, z);
          std::array<int, 3> axes{0, 1, 2};
          do {
            std::array<glm::ivec3, 4> corners{from, from, from, from};
            for (std::size_t i = 1; i < 4; ++i) {
              corners[i] = corners[i - 1];
              ++corners[i][axes[i - 1]];
            }
            add_tetrahedron(corners);
          } while (std::ranges::next_permutation(axes).found);
        }
  }

  void add_tetrahedron(const std::array<glm::ivec3, 4>& corners) {
    std::array<glm::ivec3, 4> inside, outside;
    std::size_t ins = 0, outs = 0;
    for (const glm::ivec3& corner : corners) {
      if (field_.at(place(corner)) < 0)
        inside[ins++] = corner;
      else
        outside[outs++] = corner;
    }
    if (ins == 0 || outs == 0) return;
    // The winding is corrected later by the normals.
    if (ins == 2) {
      const std::uint32_t a = crossing(inside[0], outside[0]), b = crossing(inside[0], outside[1]),
                          c = crossing(inside[1], outside[1]), d = crossing(inside[1], outside[0]);
      mesh_.triangles.emplace_back(a, b, c);
      mesh_.triangles.emplace_back(a, c, d);
    } else {
      const auto& [one, others] = ins == 1 ? std::pair(inside[0], outside) : std::pair(outside[0], inside);
      mesh_.triangles.emplace_back(crossing(one, others[0]), crossing(one, others[1]),
                                   crossing(one, others[2]));
    }
  }

  [[nodiscard]] glm::dvec3 place(const glm::dvec3& fine) const { return fine / double(pieces_); }

  /// The vertex on the edge between two points on different sides. It is created once.
  std::uint32_t crossing(const glm::ivec3& a, const glm::ivec3& b) {
    const auto number = [&](const glm::ivec3& p) {
      const auto across = [&](std::size_t axis) { return std::uint64_t(grid_.size[axis] * pieces_ + 1); };
      return (std::uint64_t(p.z) * across(1) + std::uint64_t(p.y)) * across(0) + std::uint64_t(p.x);
    };
    const glm::ivec3 low = glm::min(a, b), step = glm::max(a, b) - low;
    const std::uint64_t key = number(low) * 8 + std::uint64_t(step.x + 2 * step.y + 4 * step.z);
    const auto [at, added] = vertices_.try_emplace(key, std::uint32_t(mesh_.positions.size()));
    if (!added) return at->second;
    glm::dvec3 from = place(low), to = place(low + step);
    const bool rises = field_.at(from) < 0;
    for (int turn = 0; turn < 40; ++turn) {
      const glm::dvec3 middle = 0.5 * (from + to);
      ((field_.at(middle) < 0) == rises ? from : to) = middle;
    }
    const glm::dvec3 found = 0.5 * (from + to);
    glm::dvec3 normal = field_.gradient(found);
    if (!(glm::length(normal) > 0)) normal = {0, 0, 1};
    const glm::dvec3 cells(grid_.size[0] - 1, grid_.size[1] - 1, grid_.size[2] - 1);
    mesh_.positions.push_back(found / cells);
    mesh_.normals.emplace_back(glm::normalize(normal));
    return at->second;
  }

  const SdfGrid& grid_;
  Field field_;
  int pieces_;
  Mesh mesh_;
  std::unordered_map<std::uint64_t, std::uint32_t> vertices_;
};

}  // namespace

Expected<SdfGrid> read_sdf_grid(const SourceFile& file) {
  const auto wrong = [&](const std::string& message) {
    return fail(fmt::format("{}: {}", file.path.string(), message));
  };
  Expected<VolumeFile> read = read_volume_file(file.path.string(), file.text);
  if (!read) return std::unexpected(read.error());
  VolumeGrid& grid = read->grid;
  if (grid.channels != 1) return wrong(fmt::format("a distance is one channel, not {}", grid.channels));
  for (const int size : {grid.nx, grid.ny, grid.nz})
    if (size < 2 || size > kMostPoints)
      return wrong(fmt::format("the grid has {} points along an axis; 2 to {} are read", size, kMostPoints));
  return SdfGrid{{grid.nx, grid.ny, grid.nz}, std::move(grid.values)};
}

Mesh sdf_mesh(const SdfGrid& grid) {
  const int most = std::ranges::max(grid.size);
  return Mesher(grid, most > 256 ? 1 : most > 64 ? 2 : 4).mesh();
}

}  // namespace penumbra
