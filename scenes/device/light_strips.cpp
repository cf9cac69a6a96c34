#include "scenes/device/light_strips.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <glm/glm.hpp>
#include <utility>

#include "scenes/device/to_vec3.h"

namespace penumbra {
namespace {

using glm::dvec2;
using glm::dvec3;

// Edges along which strips are tried.
constexpr std::size_t kMostDirections = 16;
// Of the outline's height: corners that are as near are on one line.
constexpr double kSameLine = 1e-6;
// Of the area: by how much that of all strips may differ.
constexpr double kSameArea = 1e-5;
// Of the coordinates: by how much the rectangle is before the corners.
constexpr double kBefore = 0x1p-22;

struct Edge {
  dvec2 from, to;
  [[nodiscard]] bool rises() const { return to.y > from.y; }
  [[nodiscard]] double x_at(double y) const {
    return from.x + (to.x - from.x) * ((y - from.y) / (to.y - from.y));
  }
};

/// A strip as long as it is in the plane.
struct PlaneStrip {
  double low, high;              ///< in y
  double left_low, left_high;    ///< where it begins there
  double width_low, width_high;  ///< along x
  [[nodiscard]] double area() const { return 0.5 * (high - low) * (width_low + width_high); }
};

/// The outline in a plane whose x is along one of its edges.
class Sweep {
 public:
  Sweep(const Outline& outline, const dvec3& along)
      : x_(along), y_(glm::cross(outline.normal, along)), low_(1e300), high_(-1e300) {
    for (const std::vector<vec3>& loop : outline.loops)
      for (std::size_t k = 0; k < loop.size(); ++k) {
        const Edge edge{at(loop[k]), at(loop[(k + 1) % loop.size()])};
        edges_.push_back(edge);
        low_ = glm::min(low_, edge.from);
        high_ = glm::max(high_, edge.from);
      }
    put_on_lines();
  }

  /// Nothing if edges are in an order that a planar figure's are not.
  [[nodiscard]] std::optional<std::vector<PlaneStrip>> strips() const {
    std::vector<PlaneStrip> found;
    for (std::size_t k = 0; k + 1 < lines_.size(); ++k) {
      const double low = lines_[k], high = lines_[k + 1];
      std::vector<std::pair<double, const Edge*>> crossing;
      for (const Edge& e : edges_)
        if (std::min(e.from.y, e.to.y) <= low && std::max(e.from.y, e.to.y) >= high)
          crossing.emplace_back(e.x_at(0.5 * (low + high)), &e);
      std::ranges::sort(crossing);
      if (crossing.size() % 2 != 0) return std::nullopt;
      for (std::size_t i = 0; i < crossing.size(); i += 2) {
        // The inside is to the left of edges.
        const Edge &left = *crossing[i].second, &right = *crossing[i + 1].second;
        if (left.rises() || !right.rises()) return std::nullopt;
        found.push_back({low, high, left.x_at(low), left.x_at(high),
                         std::max(right.x_at(low) - left.x_at(low), 0.0),
                         std::max(right.x_at(high) - left.x_at(high), 0.0)});
      }
    }
    return found;
  }

  [[nodiscard]] const dvec3& x() const { return x_; }
  [[nodiscard]] const dvec3& y() const { return y_; }
  [[nodiscard]] const dvec2& low() const { return low_; }
  [[nodiscard]] const dvec2& high() const { return high_; }

 private:
  [[nodiscard]] dvec2 at(const vec3& p) const {
    return {glm::dot(x_, to_dvec3(p)), glm::dot(y_, to_dvec3(p))};
  }

  /// Corners that are nearly at one height have the same.
  void put_on_lines() {
    for (const Edge& e : edges_) lines_.push_back(e.from.y);
    std::ranges::sort(lines_);
    const double least = kSameLine * (high_.y - low_.y);
    std::size_t count = 0;
    for (const double y : lines_)
      if (count == 0 || y - lines_[count - 1] > least) lines_[count++] = y;
    lines_.resize(count);
    const auto line_of = [&](double y) { return *std::prev(std::ranges::upper_bound(lines_, y)); };
    for (Edge& e : edges_) {
      e.from.y = line_of(e.from.y);
      e.to.y = line_of(e.to.y);
    }
  }

  dvec3 x_, y_;
  dvec2 low_, high_;
  std::vector<Edge> edges_;
  std::vector<double> lines_;  ///< ascending
};

/// Unit vectors along the longest edges, within the plane.
std::vector<dvec3> directions_of(const Outline& outline) {
  std::vector<dvec3> edges;
  std::vector<std::pair<double, std::size_t>> order;  // by falling length
  for (const std::vector<vec3>& loop : outline.loops)
    for (std::size_t k = 0; k < loop.size(); ++k) {
      const dvec3 edge = to_dvec3(loop[(k + 1) % loop.size()]) - to_dvec3(loop[k]);
      edges.push_back(edge - glm::dot(edge, outline.normal) * outline.normal);
      order.emplace_back(-glm::length(edges.back()), edges.size() - 1);
    }
  std::ranges::sort(order);
  std::vector<dvec3> directions;
  for (const auto& [length, index] : order)
    if (length < 0 && directions.size() < kMostDirections) directions.push_back(edges[index] / -length);
  return directions;
}

AreaLightStrips area_light_of(const Outline& outline, const Sweep& sweep,
                              const std::vector<PlaneStrip>& strips) {
  double height = -1e300;
  dvec3 extent(0);
  for (const std::vector<vec3>& loop : outline.loops)
    for (const vec3& p : loop) {
      height = std::max(height, glm::dot(outline.normal, to_dvec3(p)));
      extent = glm::max(extent, glm::abs(to_dvec3(p)));
    }
  height += kBefore * glm::dot(glm::abs(outline.normal), extent);
  const dvec2 low = sweep.low(), size = sweep.high() - low;
  const auto place = [&](double x, double y) {
    return to_vec3(x * sweep.x() + y * sweep.y() + height * outline.normal);
  };
  AreaLightStrips area_light{
      {place(low.x, low.y), place(sweep.high().x, low.y), place(low.x, sweep.high().y)}, {}};
  double all = 0, before = 0;
  for (const PlaneStrip& s : strips) all += s.area();
  for (const PlaneStrip& s : strips) {
    LightStrip strip{};
    strip.start = float(before / all);
    before += s.area();
    const float share = float(before / all) - strip.start;
    strip.inverse_share = share > 0 ? 1 / share : 0.0f;
    strip.x = float((s.left_low - low.x) / size.x);
    strip.y = float((s.low - low.y) / size.y);
    strip.step_x = float((s.left_high - s.left_low) / size.x);
    strip.step_y = float((s.high - s.low) / size.y);
    strip.width = float(s.width_low / size.x);
    strip.growth = float((s.width_high - s.width_low) / size.x);
    area_light.strips.push_back(strip);
  }
  return area_light;
}

}  // namespace

std::optional<AreaLightStrips> strips_of(const Outline& outline) {
  std::size_t corners = 0;
  for (const std::vector<vec3>& loop : outline.loops) corners += loop.size();
  if (!(outline.area > 0) || corners > std::size_t(MOST_LIGHT_STRIPS)) return std::nullopt;
  std::optional<AreaLightStrips> best;
  for (const dvec3& along : directions_of(outline)) {
    const Sweep sweep(outline, along);
    const auto strips = sweep.strips();
    if (!strips || strips->size() > std::size_t(MOST_LIGHT_STRIPS)) continue;
    if (best && strips->size() >= best->strips.size()) continue;
    double area = 0;
    for (const PlaneStrip& s : *strips) area += s.area();
    if (std::abs(area - outline.area) <= kSameArea * outline.area)
      best = area_light_of(outline, sweep, *strips);
  }
  return best;
}

}  // namespace penumbra
