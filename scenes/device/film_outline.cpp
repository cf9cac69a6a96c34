#include "scenes/device/film_outline.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <tuple>

#include "scenes/device/to_vec3.h"

namespace penumbra {
namespace {

using glm::dvec2;
using glm::dvec3;

constexpr std::size_t kMostEdges = 64;  // per pixel

bool before(const dvec3& a, const dvec3& b) { return std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z); }
bool before(const dvec2& a, const dvec2& b) { return std::tie(a.x, a.y) < std::tie(b.x, b.y); }

/// The point at which the line from a to b crosses depth z. It is bitwise the same from b to a.
dvec3 cross_depth(dvec3 a, dvec3 b, double z) {
  if (before(b, a)) std::swap(a, b);
  const dvec3 p = a + (z - a.z) / (b.z - a.z) * (b - a);
  return {p.x, p.y, z};
}

/// Clips a polygon to depths beyond z, or with `side` -1 to depths below z.
std::vector<dvec3> clip_depth(const std::vector<dvec3>& polygon, double z, double side) {
  std::vector<dvec3> kept;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const dvec3 &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
    const bool a_kept = side * (a.z - z) >= 0, b_kept = side * (b.z - z) >= 0;
    if (a_kept) kept.push_back(a);
    if (a_kept != b_kept) kept.push_back(cross_depth(a, b, z));
  }
  return kept;
}

/// Clips an edge to the range [low, high] of `coordinate`. Nothing if the result is empty or a point.
std::optional<FilmEdge> clip(FilmEdge e, int coordinate, double low, double high) {
  const auto at = [&](double value) {
    dvec2 p =
        e.from + (value - e.from[coordinate]) / (e.to[coordinate] - e.from[coordinate]) * (e.to - e.from);
    p[coordinate] = value;
    return p;
  };
  const double a = e.from[coordinate], b = e.to[coordinate];
  if (std::max(a, b) <= low || std::min(a, b) >= high) return {};
  FilmEdge kept = e;
  if (a < low) kept.from = at(low);
  if (a > high) kept.from = at(high);
  if (b < low) kept.to = at(low);
  if (b > high) kept.to = at(high);
  return kept;
}

/// The first and the last pixel whose filter support overlaps [low, high].
std::array<int, 2> pixels_at(double low, double high, double radius, int size) {
  const double first = std::ceil(low - 0.5 - radius), last = std::floor(high - 0.5 + radius);
  return {int(std::clamp(first, 0.0, double(size))), int(std::clamp(last, -1.0, double(size - 1)))};
}

/// The part of a row's edges that affects the pixel. The edges are clipped to the row's filter support.
OutlinePixel edges_in_pixel(int x, int y, std::span<const FilmEdge> row, double radius) {
  OutlinePixel pixel{x, y, {}, {}};
  const dvec2 center(x + 0.5, y + 0.5);
  const double low = center.x - radius, high = center.x + radius;
  const auto local = [&](const dvec2& p) { return (p - center) / radius; };
  const auto add = [&](const FilmEdge& e) {
    if (e.from.y != e.to.y) pixel.edges.push_back({local(e.from), local(e.to)});
  };
  for (const FilmEdge& e : row) {
    if (const auto kept = clip(e, 0, low, high)) {
      pixel.inside.push_back({local(kept->from), local(kept->to)});
      add(*kept);
    }
    // Edges to the right of the support.
    if (std::min(e.from.x, e.to.x) >= high) {
      add({{high, e.from.y}, {high, e.to.y}});
    } else if (const auto right = clip(e, 0, high, std::numeric_limits<double>::infinity())) {
      add({{high, right->from.y}, {high, right->to.y}});
    }
  }
  return pixel;
}

}  // namespace

std::vector<FilmEdge> outline_on_film(const Camera& camera, const FilmParameters& film,
                                      std::span<const std::array<vec3, 3>> triangles) {
  const glm::dmat3 axes(to_dvec3(camera.x), to_dvec3(camera.y), to_dvec3(camera.z));
  const glm::dmat3 to_camera = glm::inverse(axes);
  const bool mirrored = glm::determinant(axes) > 0;
  // Number of edges from the lesser to the greater end, minus those in the opposite direction.
  std::map<std::array<double, 4>, int> counts;
  const auto to_film = [&](const dvec3& p) {
    return 0.5 * dvec2(film.width, film.height) * (1.0 - dvec2(p) / p.z);
  };
  for (const std::array<vec3, 3>& triangle : triangles) {
    std::vector<dvec3> polygon;
    for (const vec3& p : triangle) polygon.push_back(to_camera * (to_dvec3(p) - to_dvec3(camera.origin)));
    polygon = clip_depth(clip_depth(polygon, double(camera.near_clip), 1), double(camera.far_clip), -1);
    for (std::size_t i = 0; i < polygon.size(); ++i) {
      dvec2 a = to_film(polygon[i]), b = to_film(polygon[(i + 1) % polygon.size()]);
      if (mirrored) std::swap(a, b);
      if (before(a, b))
        ++counts[{a.x, a.y, b.x, b.y}];
      else if (before(b, a))
        --counts[{b.x, b.y, a.x, a.y}];
    }
  }
  std::vector<FilmEdge> edges;
  for (const auto& [ends, count] : counts)
    for (int k = 0; k < std::abs(count); ++k) {
      const dvec2 lesser(ends[0], ends[1]), greater(ends[2], ends[3]);
      edges.push_back(count > 0 ? FilmEdge{lesser, greater} : FilmEdge{greater, lesser});
    }
  return edges;
}

int OutlinePixel::winding(dvec2 p) const {
  int turns = 0;
  for (const FilmEdge& e : edges) {
    const bool below_start = e.from.y <= p.y, below_end = e.to.y <= p.y;
    if (below_start == below_end) continue;
    const double crossing = e.from.x + (p.y - e.from.y) / (e.to.y - e.from.y) * (e.to.x - e.from.x);
    if (p.x < crossing) turns += below_start ? 1 : -1;
  }
  return turns;
}

double OutlinePixel::share(const FilterMass& filter) const {
  // Integrates F(x) dG(y) over pieces of edges, where F and G are cumulative distributions of the filter.
  // Both are interpolated quadratically through the ends and the middle of a piece. This is exact for a box
  // and a tent between their kinks.
  constexpr double kLongest = 1.0 / 32;
  double sum = 0;
  for (const FilmEdge& e : edges) {
    const dvec2 way = e.to - e.from;
    std::vector<double> breaks{0, 1};
    for (int axis = 0; axis < 2; ++axis)
      if (e.from[axis] * e.to[axis] < 0) breaks.push_back(-e.from[axis] / way[axis]);
    std::ranges::sort(breaks);
    for (std::size_t i = 0; i + 1 < breaks.size(); ++i) {
      const double length = std::max(std::abs(way.x), std::abs(way.y)) * (breaks[i + 1] - breaks[i]);
      const int steps = way.x == 0 ? 1 : std::max(1, int(std::ceil(length / kLongest)));
      const double step = (breaks[i + 1] - breaks[i]) / steps;
      const auto mass_at = [&](double k) {
        const dvec2 p = e.from + (breaks[i] + k * step) * way;
        return dvec2(filter.up_to(p.x), filter.up_to(p.y));
      };
      dvec2 start = mass_at(0);
      for (int k = 0; k < steps; ++k) {
        const dvec2 middle = mass_at(k + 0.5), end = mass_at(k + 1);
        const dvec2 linear = 0.5 * (end - start), bend = 0.5 * (start + end) - middle;
        sum += 2 * linear.y * (middle.x + bend.x / 3) + 4.0 / 3 * linear.x * bend.y;
        start = end;
      }
    }
  }
  return sum;
}

std::vector<OutlinePixel> outline_pixels(std::span<const FilmEdge> edges, const FilmParameters& film) {
  const auto radius = double(film.filter_radius);
  std::map<int, std::vector<FilmEdge>> rows;
  for (const FilmEdge& e : edges) {
    const auto [first, last] =
        pixels_at(std::min(e.from.y, e.to.y), std::max(e.from.y, e.to.y), radius, film.height);
    for (int y = first; y <= last; ++y) {
      const double low = y + 0.5 - radius, high = y + 0.5 + radius;
      if (const auto kept = clip(e, 1, low, high)) rows[y].push_back(*kept);
    }
  }
  std::vector<OutlinePixel> pixels;
  for (const auto& [y, row] : rows) {
    std::vector<int> crossed;
    for (const FilmEdge& e : row) {
      const auto [first, last] =
          pixels_at(std::min(e.from.x, e.to.x), std::max(e.from.x, e.to.x), radius, film.width);
      for (int x = first; x <= last; ++x) crossed.push_back(x);
    }
    std::ranges::sort(crossed);
    crossed.erase(std::unique(crossed.begin(), crossed.end()), crossed.end());
    for (const int x : crossed) {
      OutlinePixel pixel = edges_in_pixel(x, y, row, radius);
      if (!pixel.inside.empty() && pixel.edges.size() <= kMostEdges) pixels.push_back(std::move(pixel));
    }
  }
  return pixels;
}

}  // namespace penumbra
