#include "scenes/device/light_tree_builder.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include "scenes/device/to_vec3.h"

namespace penumbra {
namespace {

constexpr int kBuckets = 12;

/// What a node costs: its intensity times how far its lights are apart and how differently they face.
double cost_of(const LightBounds& b) {
  const double o = b.spread, w = std::min(o + b.reach, std::numbers::pi);
  const double solid = 2 * (1 - std::cos(o)) +
                       0.5 * (2 * w * std::sin(o) - std::cos(o - 2 * w) - 2 * o * std::sin(o) + std::cos(o));
  const glm::dvec3 d = b.high - b.low;
  const double area = d.x * d.y + d.y * d.z + d.z * d.x + glm::dot(d, d);
  return b.intensity * solid * area;
}

float above(double x) {
  const auto f = float(x);
  return double(f) >= x ? f : std::nextafter(f, std::numeric_limits<float>::infinity());
}

/// The node's numbers, rounded so that they still bound.
LightNode node_of(const LightBounds& b, double unit) {
  constexpr double kSlack = 1e-6;  // of angles in single precision
  LightNode node{};
  node.center = to_vec3(0.5 * (b.low + b.high));
  const glm::dvec3 center(node.center.x, node.center.y, node.center.z);
  const glm::dvec3 half = glm::max(b.high - center, center - b.low);
  node.half_size = make_vec3(above(half.x), above(half.y), above(half.z));
  node.axis = to_vec3(b.axis);
  const double spread = b.spread > 0 ? std::min(b.spread + kSlack, std::numbers::pi) : 0.0;
  node.cos_o = float(std::cos(spread));
  node.sin_o = spread < std::numbers::pi ? float(std::sin(spread)) : 0.0f;
  const double reach = std::min(b.reach, std::numbers::pi);
  // A right angle is that of surfaces, exactly.
  node.cos_e = std::abs(reach - 0.5 * std::numbers::pi) < kSlack ? 0.0f : float(std::cos(reach + kSlack));
  if (reach >= std::numbers::pi) node.cos_e = -2.0f;
  node.intensity = float(std::clamp(b.intensity * unit, 1e-30, 1e30));
  node.radius = above(double(length3(node.half_size)) * (1 + 1e-6));
  node.inverse_radius = node.radius > 0 ? std::min(1 / node.radius, 1e18f) : 1e18f;
  node.flags = (b.two_sided ? LIGHTS_TWO_SIDED : 0) | (b.infinite ? LIGHTS_INFINITE : 0);
  return node;
}

class Builder {
 public:
  Builder(std::span<const LightBounds> lights, double unit) : lights_(lights), unit_(unit) {
    tree_.trails.resize(lights.size(), 0);
  }

  LightTree build() {
    std::vector<int> finite, infinite;
    for (std::size_t i = 0; i < lights_.size(); ++i)
      if (lights_[i].intensity > 0) (lights_[i].infinite ? infinite : finite).push_back(int(i));
    const std::vector<std::span<int>> cut = cut_of(finite, infinite);
    tree_.cut = int(cut.size());
    tree_.nodes.resize(cut.size());
    for (std::size_t k = 0; k < cut.size(); ++k) add(int(k), cut[k], 0, std::uint32_t(k));
    return std::move(tree_);
  }

 private:
  [[nodiscard]] const LightBounds& of(int light) const { return lights_[std::size_t(light)]; }
  [[nodiscard]] glm::dvec3 middle(int light) const { return 0.5 * (of(light).low + of(light).high); }
  [[nodiscard]] LightBounds bounds_of(std::span<const int> lights) const {
    LightBounds all = of(lights[0]);
    for (const int light : lights.subspan(1)) all = joined(all, of(light));
    return all;
  }

  /// Splits what costs most again and again.
  std::vector<std::span<int>> cut_of(std::span<int> finite, std::span<int> infinite) {
    std::vector<std::span<int>> cut;
    for (const std::span<int> lights : {finite, infinite})
      if (!lights.empty()) cut.push_back(lights);
    while (!cut.empty() && cut.size() < LIGHT_CUT) {
      std::size_t most = 0;
      double highest = -1;
      for (std::size_t k = 0; k < cut.size(); ++k)
        if (const double cost = cut[k].size() > 1 ? cost_of(bounds_of(cut[k])) : -1; cost > highest) {
          most = k;
          highest = cost;
        }
      if (highest < 0) break;
      const std::span<int> lights = cut[most];
      const std::size_t first = split(lights, kMaxLightTreeDepth);
      cut[most] = lights.first(first);
      cut.insert(cut.begin() + std::ptrdiff_t(most) + 1, lights.subspan(first));
    }
    return cut;
  }

  int add_pair(int parent) {
    const int pair = int(tree_.nodes.size());
    tree_.nodes.resize(tree_.nodes.size() + 2);
    tree_.nodes[std::size_t(parent)].child = pair;
    return pair;
  }

  /// Makes node `index`, `depth` turns below the cut along `trail`.
  void add(int index, std::span<int> lights, int depth, std::uint32_t trail) {
    tree_.depth = std::max(tree_.depth, depth);
    tree_.nodes[std::size_t(index)] = node_of(bounds_of(lights), unit_);
    if (lights.size() == 1) {
      tree_.nodes[std::size_t(index)].child = ~lights[0];
      tree_.trails[std::size_t(lights[0])] = trail;
      return;
    }
    const std::size_t first = split(lights, kMaxLightTreeDepth - depth);
    const int pair = add_pair(index);
    add(pair, lights.first(first), depth + 1, trail);
    add(pair + 1, lights.subspan(first), depth + 1, trail | std::uint32_t(LIGHT_CUT) << depth);
  }

  /// Orders the lights and returns how many of them the first child gets; `levels` may follow.
  std::size_t split(std::span<int> lights, int levels) {
    const bool may_lean = int(std::bit_width(lights.size() - 1)) < levels;
    glm::dvec3 low = middle(lights[0]), high = low;
    for (const int light : lights) {
      low = glm::min(low, middle(light));
      high = glm::max(high, middle(light));
    }
    if (may_lean)
      if (const std::optional<std::size_t> found = best_split(lights, low, high)) return *found;
    const glm::dvec3 d = high - low;
    const int axis = d.x >= d.y && d.x >= d.z ? 0 : d.y >= d.z ? 1 : 2;
    std::ranges::sort(lights, [&](int a, int b) {
      const double at_a = middle(a)[axis], at_b = middle(b)[axis];
      return at_a != at_b ? at_a < at_b : a < b;
    });
    return lights.size() / 2;
  }

  std::optional<std::size_t> best_split(std::span<int> lights, const glm::dvec3& low,
                                        const glm::dvec3& high) {
    const glm::dvec3 extent = high - low;
    const double longest = std::max({extent.x, extent.y, extent.z});
    double best = std::numeric_limits<double>::infinity();
    int best_axis = -1, best_bucket = 0;
    const auto bucket_of = [&](int light, int axis) {
      return std::min(kBuckets - 1, int((middle(light)[axis] - low[axis]) / extent[axis] * kBuckets));
    };
    for (int axis = 0; axis < 3; ++axis) {
      if (!(extent[axis] > 1e-9 * longest)) continue;
      std::array<std::optional<LightBounds>, kBuckets> buckets;
      for (const int light : lights) {
        auto& bucket = buckets[std::size_t(bucket_of(light, axis))];
        bucket = bucket ? joined(*bucket, of(light)) : of(light);
      }
      std::array<double, kBuckets> costs{};
      std::optional<LightBounds> sum;
      for (int k = 0; k + 1 < kBuckets; ++k) {
        add_to(sum, buckets[std::size_t(k)]);
        costs[std::size_t(k)] = sum ? cost_of(*sum) : std::numeric_limits<double>::infinity();
      }
      sum.reset();
      for (int k = kBuckets - 1; k > 0; --k) {
        add_to(sum, buckets[std::size_t(k)]);
        costs[std::size_t(k - 1)] += sum ? cost_of(*sum) : std::numeric_limits<double>::infinity();
      }
      // Thin slabs are bad bounds.
      const double thinness = longest / extent[axis];
      for (int k = 0; k + 1 < kBuckets; ++k)
        if (thinness * costs[std::size_t(k)] < best) {
          best = thinness * costs[std::size_t(k)];
          best_axis = axis;
          best_bucket = k;
        }
    }
    if (best_axis < 0) return std::nullopt;
    std::vector<int> second;
    std::size_t first = 0;
    for (const int light : lights) {
      if (bucket_of(light, best_axis) <= best_bucket)
        lights[first++] = light;
      else
        second.push_back(light);
    }
    std::ranges::copy(second, lights.begin() + std::ptrdiff_t(first));
    return first;
  }

  static void add_to(std::optional<LightBounds>& sum, const std::optional<LightBounds>& more) {
    if (more) sum = sum ? joined(*sum, *more) : *more;
  }

  std::span<const LightBounds> lights_;
  double unit_;
  LightTree tree_;
};

}  // namespace

LightTree build_light_tree(std::span<const LightBounds> lights, double unit) {
  return Builder(lights, unit).build();
}

}  // namespace penumbra
