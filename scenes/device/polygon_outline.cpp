#include "scenes/device/polygon_outline.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <limits>
#include <unordered_map>
#include <utility>

#include "scenes/device/outline_loops.h"
#include "scenes/device/to_vec3.h"

namespace penumbra {
namespace {

using glm::dvec3;

// Tolerance for planarity, relative to a patch's extent. In files with six decimals the vertices of a polygon
// of a tenth of a unit are this far off their plane.
constexpr double kFlatness = 1e-5;
// Tolerance relative to the coordinates: twice the error of a point relative to two others due to rounding to
// single precision.
constexpr double kRounding = 0x1p-22;
constexpr double kSquareness = 1e-5;
// If more triangles than this share an edge, they are not merged across it, because every pair would be
// tried.
constexpr std::size_t kMaxAtEdge = 32;

struct CornerBox {
  dvec3 low{std::numeric_limits<double>::infinity()}, high{-std::numeric_limits<double>::infinity()};
  void include(const dvec3& p) {
    low = glm::min(low, p);
    high = glm::max(high, p);
  }
  [[nodiscard]] double diagonal() const { return glm::length(high - low); }
};

/// Triangles over distinct vertices, which are numbered in order of appearance.
struct Indexed {
  std::vector<dvec3> vertices;
  std::vector<std::array<int, 3>> triangles;
};

Indexed index_vertices(std::span<const LightTriangle> triangles) {
  struct Hash {
    std::size_t operator()(const std::array<float, 3>& p) const {
      std::uint64_t h = 0;
      for (const float x : p)  // + 0 makes both zeros equal
        h = (h ^ (h >> 29) ^ std::hash<float>()(x + 0.0f)) * 0x9e3779b97f4a7c15ULL;
      return std::size_t(h ^ (h >> 32));
    }
  };
  Indexed out;
  std::unordered_map<std::array<float, 3>, int, Hash> index;
  index.reserve(triangles.size());
  const auto find = [&](const vec3& p) {
    const auto [at, added] = index.try_emplace({p.x, p.y, p.z}, int(out.vertices.size()));
    if (added) out.vertices.emplace_back(p.x, p.y, p.z);
    return at->second;
  };
  for (const LightTriangle& t : triangles) {
    const int a = find(t.p0), b = find(t.p1), c = find(t.p2);
    out.triangles.push_back({a, b, c});
  }
  return out;
}

/// Triangles that have the vertices of an earlier one in the same cyclic order.
std::vector<int> find_duplicates(const Indexed& mesh) {
  std::vector<std::pair<std::array<int, 3>, int>> keys;
  for (std::array<int, 3> t : mesh.triangles) {
    std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
    keys.emplace_back(t, int(keys.size()));
  }
  std::sort(keys.begin(), keys.end());
  std::vector<int> duplicates;
  for (std::size_t i = 1; i < keys.size(); ++i)
    if (keys[i].first == keys[i - 1].first) duplicates.push_back(keys[i].second);
  std::sort(duplicates.begin(), duplicates.end());
  return duplicates;
}

/// Finds the triangles that have a side of a given triangle in the opposite direction.
class Neighbours {
 public:
  Neighbours(const Indexed& mesh, const std::vector<char>& left_out) : sides_(3 * mesh.triangles.size()) {
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
      for (std::size_t k = 0; k < 3 && !left_out[t]; ++k) {
        const int a = mesh.triangles[t][k], b = mesh.triangles[t][(k + 1) % 3];
        if (a != b) order_.push_back({std::min(a, b), std::max(a, b), a < b, int(t), int(k)});
      }
    std::sort(order_.begin(), order_.end());
    for (std::size_t begin = 0, end = 0; begin < order_.size(); begin = end) {
      while (end < order_.size() && order_[end].low == order_[begin].low &&
             order_[end].high == order_[begin].high)
        ++end;
      for (std::size_t i = begin; i < end && end - begin <= kMaxAtEdge; ++i)
        sides_[std::size_t(3 * order_[i].triangle + order_[i].side)] = {begin, end, order_[i].up};
    }
  }

  template <typename F>
  void for_each(int triangle, F&& visit) const {
    for (int k = 0; k < 3; ++k) {
      const Range& range = sides_[std::size_t(3 * triangle + k)];
      for (std::size_t i = range.begin; i < range.end; ++i)
        if (order_[i].up != range.up) visit(order_[i].triangle);
    }
  }

 private:
  struct Side {
    int low, high;
    bool up;  ///< from the lower to the higher vertex
    int triangle, side;
    auto operator<=>(const Side&) const = default;
  };
  struct Range {
    std::size_t begin = 0, end = 0;
    bool up = false;
  };
  std::vector<Side> order_;
  std::vector<Range> sides_;  ///< for each side the range in order_ of all sides with the same two vertices
};

/// A growing set of triangles in one plane, with the mean plane.
class Patch {
 public:
  Patch(const Indexed& mesh, int seed) : mesh_(mesh) { add(seed); }

  void add(int triangle) {
    const auto [a, b, c] = corners(triangle);
    const dvec3 area_vector = 0.5 * glm::cross(b - a, c - a);
    const double added = glm::length(area_vector);
    triangles.push_back(triangle);
    area_vector_ += area_vector;
    area += added;
    moment_ += added / 3 * (a + b + c);
    for (const dvec3& p : {a, b, c}) box.include(p);
  }

  [[nodiscard]] bool accepts(int triangle) const {
    const std::array<dvec3, 3> p = corners(triangle);
    if (!(area > 0) || !(glm::dot(glm::cross(p[1] - p[0], p[2] - p[0]), area_vector_) > 0)) return false;
    CornerBox extent = box;
    for (const dvec3& corner : p) extent.include(corner);
    const dvec3 n = normal(), at = moment_ / area;
    for (const dvec3& corner : p) {
      const double rounding = kRounding * glm::dot(glm::abs(n), glm::abs(corner));
      if (std::abs(glm::dot(n, corner - at)) > kFlatness * extent.diagonal() + rounding) return false;
    }
    return true;
  }

  [[nodiscard]] dvec3 normal() const { return glm::normalize(area_vector_); }

  std::vector<int> triangles;
  double area = 0;
  CornerBox box;

 private:
  [[nodiscard]] std::array<dvec3, 3> corners(int triangle) const {
    const std::array<int, 3>& t = mesh_.triangles[std::size_t(triangle)];
    return {mesh_.vertices[std::size_t(t[0])], mesh_.vertices[std::size_t(t[1])],
            mesh_.vertices[std::size_t(t[2])]};
  }

  const Indexed& mesh_;
  dvec3 area_vector_{0}, moment_{0};
};

/// Adds all triangles that can be reached from the patch's seed and lie in its plane. The mean plane becomes
/// more accurate as triangles are added, so those that did not fit are tried again at the end.
void grow(Patch& patch, const Neighbours& neighbours, std::vector<char>& taken) {
  std::vector<int> refused;
  std::size_t next = 0;
  const auto advance = [&] {
    for (; next < patch.triangles.size(); ++next)
      neighbours.for_each(patch.triangles[next], [&](int candidate) {
        if (taken[std::size_t(candidate)]) return;
        if (!patch.accepts(candidate)) return refused.push_back(candidate);
        taken[std::size_t(candidate)] = 1;
        patch.add(candidate);
      });
  };
  advance();
  for (int pass = 0; pass < 4; ++pass) {
    const std::size_t before = patch.triangles.size();
    for (const int candidate : std::exchange(refused, {})) {
      if (taken[std::size_t(candidate)]) continue;
      if (!patch.accepts(candidate)) {
        refused.push_back(candidate);
        continue;
      }
      taken[std::size_t(candidate)] = 1;
      patch.add(candidate);
    }
    if (patch.triangles.size() == before) break;
    advance();
  }
}

/// The edges of the triangles that remain after edges in opposite directions have cancelled.
std::vector<OutlineEdge> boundary(const Indexed& mesh, const std::vector<int>& triangles) {
  std::vector<std::array<int, 3>> sides;  // low, high, 1 upwards or -1 downwards
  for (const int t : triangles)
    for (std::size_t k = 0; k < 3; ++k) {
      const int a = mesh.triangles[std::size_t(t)][k], b = mesh.triangles[std::size_t(t)][(k + 1) % 3];
      sides.push_back({std::min(a, b), std::max(a, b), a < b ? 1 : -1});
    }
  std::sort(sides.begin(), sides.end());
  std::vector<OutlineEdge> edges;
  for (std::size_t i = 0; i < sides.size();) {
    const auto [low, high, unused] = sides[i];
    int count = 0;
    for (; i < sides.size() && sides[i][0] == low && sides[i][1] == high; ++i) count += sides[i][2];
    for (; count > 0; --count) edges.push_back({low, high});
    for (; count < 0; ++count) edges.push_back({high, low});
  }
  return edges;
}

std::optional<std::array<vec3, 3>> as_rectangle(const std::array<dvec3, 4>& p) {
  const dvec3 next = p[1] - p[0], previous = p[3] - p[0];
  const double a = glm::length(next), b = glm::length(previous), limit = kSquareness * std::min(a, b);
  if (glm::length(p[2] - p[3] - next) > limit) return std::nullopt;
  if (std::abs(glm::dot(next, previous)) > limit * std::max(a, b)) return std::nullopt;
  return std::array<vec3, 3>{to_vec3(p[0]), to_vec3(p[1]), to_vec3(p[3])};
}

Outline outline_of(Patch patch, const Indexed& mesh, std::span<const LightTriangle> triangles) {
  Outline outline;
  outline.area = patch.area;
  if (patch.area > 0) outline.normal = patch.normal();
  outline.size = std::nextafter(float(patch.box.diagonal()), std::numeric_limits<float>::infinity());
  outline.triangles = std::move(patch.triangles);
  if (outline.triangles.size() == 1) {
    const LightTriangle& t = triangles[std::size_t(outline.triangles[0])];
    outline.loops = {{t.p0, t.p1, t.p2}};
    return outline;
  }
  std::sort(outline.triangles.begin(), outline.triangles.end());
  const OutlinePlane plane(mesh.vertices, 0.5 * (patch.box.low + patch.box.high), patch.normal());
  const double tolerance =
      kRounding * glm::length(glm::max(glm::abs(patch.box.low), glm::abs(patch.box.high)));
  std::vector<Loop> loops =
      simplify_loops(chain_edges(boundary(mesh, outline.triangles), plane), plane, tolerance);
  for (Loop& loop : loops) std::rotate(loop.begin(), std::min_element(loop.begin(), loop.end()), loop.end());
  std::sort(loops.begin(), loops.end());
  const auto vertex = [&](int v) { return mesh.vertices[std::size_t(v)]; };
  for (const Loop& loop : loops) {
    std::vector<vec3>& corners = outline.loops.emplace_back();
    for (const int v : loop) corners.push_back(to_vec3(vertex(v)));
  }
  if (outline.triangles.size() == 2 && loops.size() == 1 && loops[0].size() == 4)
    outline.rectangle =
        as_rectangle({vertex(loops[0][0]), vertex(loops[0][1]), vertex(loops[0][2]), vertex(loops[0][3])});
  return outline;
}

}  // namespace

Outlines merge_coplanar(std::span<const LightTriangle> triangles) {
  const Indexed mesh = index_vertices(triangles);
  Outlines out;
  out.duplicates = find_duplicates(mesh);
  std::vector<char> taken(triangles.size());
  for (const int t : out.duplicates) taken[std::size_t(t)] = 1;
  const Neighbours neighbours(mesh, taken);

  // Largest first, because their planes are known best.
  std::vector<std::pair<double, int>> seeds;
  for (std::size_t t = 0; t < triangles.size(); ++t)
    if (!taken[t]) seeds.emplace_back(-Patch(mesh, int(t)).area, int(t));
  std::sort(seeds.begin(), seeds.end());
  for (const auto& [area, seed] : seeds) {
    if (std::exchange(taken[std::size_t(seed)], 1)) continue;
    Patch patch(mesh, seed);
    grow(patch, neighbours, taken);
    out.outlines.push_back(outline_of(std::move(patch), mesh, triangles));
  }
  std::sort(out.outlines.begin(), out.outlines.end(),
            [](const Outline& a, const Outline& b) { return a.triangles[0] < b.triangles[0]; });
  return out;
}

}  // namespace penumbra
