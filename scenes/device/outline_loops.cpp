#include "scenes/device/outline_loops.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <numeric>
#include <unordered_map>
#include <utility>

namespace penumbra {
namespace {

using glm::dvec2;
using glm::dvec3;

// The largest relative change of area from removing corners of straight sides.
constexpr double kAreaChange = 1e-5;

double cross(const dvec2& a, const dvec2& b) { return a.x * b.y - a.y * b.x; }

/// Determines the successor of each edge at its end. If several edges meet there, an edge is followed by the
/// one that bounds the same wedge of the inside, which is the next one clockwise. So loops may touch there
/// but never cross.
std::vector<int> successors(const std::vector<OutlineEdge>& edges, const OutlinePlane& plane) {
  std::vector<int> in(edges.size()), out(edges.size()), next(edges.size());
  std::iota(in.begin(), in.end(), 0);
  std::iota(out.begin(), out.end(), 0);
  const auto edge = [&](int i) -> const OutlineEdge& { return edges[std::size_t(i)]; };
  std::sort(in.begin(), in.end(),
            [&](int a, int b) { return std::pair(edge(a).to, a) < std::pair(edge(b).to, b); });
  std::sort(out.begin(), out.end(),
            [&](int a, int b) { return std::pair(edge(a).from, a) < std::pair(edge(b).from, b); });
  // At each vertex as many edges end as start, so a vertex has the same positions in both orders.
  struct Spoke {
    double clockwise;
    bool leaves;
    int edge;
    auto operator<=>(const Spoke&) const = default;
  };
  for (std::size_t begin = 0, end = 0; begin < edges.size(); begin = end) {
    const int vertex = edge(in[begin]).to;
    while (end < edges.size() && edge(in[end]).to == vertex) ++end;
    if (end == begin + 1) {
      next[std::size_t(in[begin])] = out[begin];
      continue;
    }
    std::vector<Spoke> spokes;
    for (std::size_t i = begin; i < end; ++i)
      for (const bool leaves : {false, true}) {
        const int e = leaves ? out[i] : in[i];
        const dvec2 d = plane.at(leaves ? edge(e).to : edge(e).from) - plane.at(vertex);
        spokes.push_back({-std::atan2(d.y, d.x), leaves, e});
      }
    std::sort(spokes.begin(), spokes.end());
    // Pair them like brackets around the circle.
    std::vector<int> open, unmatched;
    for (const Spoke& spoke : spokes) {
      if (!spoke.leaves) {
        open.push_back(spoke.edge);
      } else if (open.empty()) {
        unmatched.push_back(spoke.edge);
      } else {
        next[std::size_t(open.back())] = spoke.edge;
        open.pop_back();
      }
    }
    for (const int e : unmatched) {
      next[std::size_t(open.back())] = e;
      open.pop_back();
    }
  }
  return next;
}

double signed_area(const Loop& loop, const OutlinePlane& plane) {
  double twice = 0;
  for (std::size_t i = 0; i < loop.size(); ++i)
    twice += cross(plane.at(loop[i]), plane.at(loop[(i + 1) % loop.size()]));
  return 0.5 * twice;
}

/// Removes corners that are within `tolerance` of the straight line between the remaining ones. Sklansky and
/// Gonzalez 1980, Fast Polygonal Approximation of Digitized Curves: keep the wedge of directions in which a
/// line from the last corner passes close enough to all corners removed since.
Loop straighten(Loop loop, const OutlinePlane& plane, double tolerance) {
  // Start at the corner farthest from some point; such a corner is never in the middle of a side.
  const dvec2 start = plane.at(loop[0]);
  const auto farther = [&](int a, int b) {
    return glm::distance(plane.at(a), start) < glm::distance(plane.at(b), start);
  };
  std::rotate(loop.begin(), std::max_element(loop.begin(), loop.end(), farther), loop.end());
  Loop kept;
  dvec2 anchor, reference;
  double low, high, reached;
  const auto restart = [&](int corner) {
    kept.push_back(corner);
    anchor = plane.at(corner);
    reference = dvec2(0);
    low = -std::numbers::pi;
    high = std::numbers::pi;
    reached = 0;
  };
  restart(loop[0]);
  for (std::size_t i = 1; i <= loop.size(); ++i) {
    for (;;) {
      const dvec2 d = plane.at(loop[i % loop.size()]) - anchor;
      const double distance = glm::length(d);
      const bool unbound = reference == dvec2(0);
      const double angle = unbound ? 0 : std::atan2(cross(reference, d), glm::dot(reference, d));
      if (distance > reached && angle >= low && angle <= high) {
        reached = distance;
        if (distance > tolerance) {
          if (unbound) reference = d;
          const double half = std::asin(tolerance / distance);
          low = std::max(low, angle - half);
          high = std::min(high, angle + half);
        }
        break;
      }
      if (kept.back() == loop[i - 1]) break;  // back at the start
      restart(loop[i - 1]);
    }
  }
  return kept;
}

}  // namespace

OutlinePlane::OutlinePlane(const std::vector<dvec3>& vertices, const dvec3& origin, const dvec3& normal)
    : vertices_(vertices), origin_(origin) {
  const dvec3 a = glm::abs(normal);
  const dvec3 axis = a.x <= a.y && a.x <= a.z ? dvec3(1, 0, 0) : a.y <= a.z ? dvec3(0, 1, 0) : dvec3(0, 0, 1);
  x_ = glm::normalize(glm::cross(axis, normal));
  y_ = glm::cross(normal, x_);
}

std::vector<Loop> chain_edges(const std::vector<OutlineEdge>& edges, const OutlinePlane& plane) {
  std::vector<int> next = successors(edges, plane);
  std::vector<Loop> loops;
  std::unordered_map<int, std::size_t> place;  // in `path`
  Loop path;
  for (std::size_t first = 0; first < edges.size(); ++first) {
    for (int e = int(first); next[std::size_t(e)] >= 0; e = std::exchange(next[std::size_t(e)], -1)) {
      const int vertex = edges[std::size_t(e)].from;
      const auto [at, added] = place.try_emplace(vertex, path.size());
      if (!added) {
        const auto begin = path.begin() + std::ptrdiff_t(at->second);
        loops.emplace_back(begin, path.end());
        for (auto v = begin + 1; v != path.end(); ++v) place.erase(*v);
        path.erase(begin + 1, path.end());
        continue;
      }
      path.push_back(vertex);
    }
    if (!path.empty()) loops.push_back(std::exchange(path, {}));
    place.clear();
  }
  return loops;
}

std::vector<Loop> simplify_loops(const std::vector<Loop>& loops, const OutlinePlane& plane,
                                 double tolerance) {
  std::vector<Loop> simple;
  double before = 0, after = 0;
  for (const Loop& loop : loops) {
    before += signed_area(loop, plane);
    Loop kept = straighten(loop, plane, tolerance);
    if (kept.size() < 3) continue;
    after += signed_area(kept, plane);
    simple.push_back(std::move(kept));
  }
  return std::abs(after - before) <= kAreaChange * before ? simple : loops;
}

}  // namespace penumbra
