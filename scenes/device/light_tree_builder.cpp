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

/// The cost of a node: its intensity times a measure of how far its lights are apart and how differently they
/// face.
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

/// The node's record, rounded conservatively.
LightNode node_of(const LightBounds& b, double unit) {
  constexpr double kSlack = 1e-6;  // error of angles in single precision
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
  // A right angle, which surfaces have, is kept exact.
  node.cos_e = std::abs(reach - 0.5 * std::numbers::pi) < kSlack ? 0.0f : float(std::cos(reach + kSlack));
  if (reach >= std::numbers::pi) node.cos_e = -2.0f;
  node.intensity = float(std::clamp(b.intensity * unit, 1e-30, 1e30));
  node.radius = above(double(length3(node.half_size)) * (1 + 1e-6));
  node.inverse_radius = node.radius > 0 ? std::min(1 / node.radius, 1e18f) : 1e18f;
  node.flags = (b.two_sided ? LIGHTS_TWO_SIDED : 0) | (b.infinite ? LIGHTS_INFINITE : 0);
  return node;
}

/// Builds the tree over items: clusters of lights, or single lights.
class TreeBuilder {
 public:
  TreeBuilder(std::span<const LightBounds> lights, double unit, std::span<const LightGroup> groups,
              int most_of_cut)
      : lights_(lights), unit_(unit), most_of_cut_(std::size_t(most_of_cut)) {
    tree_.trails.resize(lights.size(), 0);
    std::vector<int> group_of(lights.size(), -1);
    for (std::size_t g = 0; g < groups.size(); ++g)
      for (const int light : groups[g]) group_of[std::size_t(light)] = int(g);
    std::vector<bool> added(groups.size(), false);
    for (std::size_t i = 0; i < lights.size(); ++i) {
      if (!(lights[i].intensity > 0)) continue;
      const int g = group_of[i];
      if (g >= 0 && added[std::size_t(g)]) continue;
      if (g >= 0) added[std::size_t(g)] = true;
      items_.push_back(g < 0 ? LightGroup{int(i)} : groups[std::size_t(g)]);
      LightBounds all = lights[std::size_t(items_.back()[0])];
      for (const int light : std::span(items_.back()).subspan(1))
        all = joined(all, lights[std::size_t(light)]);
      bounds_.push_back(all);
    }
    const bool several = std::ranges::any_of(items_, [](const LightGroup& g) { return g.size() > 1; });
    if (several) tree_.numbers.resize(lights.size(), 0);
  }

  LightTree build() {
    std::vector<int> finite, infinite;
    for (std::size_t i = 0; i < bounds_.size(); ++i)
      (bounds_[i].infinite ? infinite : finite).push_back(int(i));
    const std::vector<std::span<int>> cut = cut_of(finite, infinite);
    tree_.cut = int(cut.size());
    tree_.nodes.resize(cut.size());
    for (std::size_t k = 0; k < cut.size(); ++k) add(int(k), cut[k], 0, std::uint32_t(k));
    return std::move(tree_);
  }

 private:
  [[nodiscard]] const LightBounds& of(int item) const { return bounds_[std::size_t(item)]; }
  [[nodiscard]] glm::dvec3 middle(int item) const { return 0.5 * (of(item).low + of(item).high); }
  [[nodiscard]] LightBounds bounds_of(std::span<const int> items) const {
    LightBounds all = of(items[0]);
    for (const int item : items.subspan(1)) all = joined(all, of(item));
    return all;
  }

  /// Splits the most expensive node repeatedly.
  std::vector<std::span<int>> cut_of(std::span<int> finite, std::span<int> infinite) {
    std::vector<std::span<int>> cut;
    for (const std::span<int> items : {finite, infinite})
      if (!items.empty()) cut.push_back(items);
    while (!cut.empty() && cut.size() < most_of_cut_) {
      std::size_t most = 0;
      double highest = -1;
      for (std::size_t k = 0; k < cut.size(); ++k)
        if (const double cost = cut[k].size() > 1 ? cost_of(bounds_of(cut[k])) : -1; cost > highest) {
          most = k;
          highest = cost;
        }
      if (highest < 0) break;
      const std::span<int> items = cut[most];
      const std::size_t first = split(items, kMaxLightTreeDepth);
      cut[most] = items.first(first);
      cut.insert(cut.begin() + std::ptrdiff_t(most) + 1, items.subspan(first));
    }
    return cut;
  }

  /// Makes the node a leaf with these lights.
  void add_leaf(LightNode& node, const LightGroup& lights, std::uint32_t trail) {
    for (const int light : lights) tree_.trails[std::size_t(light)] = trail;
    node.lights = int(lights.size());
    node.child = ~lights[0];
    if (!tree_.numbers.empty()) tree_.numbers[std::size_t(lights[0])] = int(LIGHT_PROBABILITY_STEPS);
    if (lights.size() == 1) return;
    node.child = ~int(tree_.members.size());
    tree_.leaf_turns = std::max(tree_.leaf_turns, int(std::bit_width(lights.size() - 1)));
    double all = 0, before = 0;
    for (const int light : lights) all += lights_[std::size_t(light)].intensity;
    // Each light gets at least one number.
    const int spare = int(LIGHT_PROBABILITY_STEPS) - int(lights.size());
    const auto end_of = [&](std::size_t k) { return int(std::min(before / all, 1.0) * spare) + int(k); };
    int start = 0;
    for (std::size_t k = 0; k < lights.size(); ++k) {
      before += lights_[std::size_t(lights[k])].intensity;
      const int end = k + 1 == lights.size() ? int(LIGHT_PROBABILITY_STEPS) : end_of(k + 1);
      tree_.members.push_back({lights[k], start});
      tree_.numbers[std::size_t(lights[k])] = end - start;
      start = end;
    }
  }

  int add_pair(int parent) {
    const int pair = int(tree_.nodes.size());
    tree_.nodes.resize(tree_.nodes.size() + 2);
    tree_.nodes[std::size_t(parent)].child = pair;
    return pair;
  }

  /// Builds node `index`, which is `depth` levels below the cut at the end of `trail`.
  void add(int index, std::span<int> items, int depth, std::uint32_t trail) {
    tree_.depth = std::max(tree_.depth, depth);
    tree_.nodes[std::size_t(index)] = node_of(bounds_of(items), unit_);
    if (items.size() == 1) {
      add_leaf(tree_.nodes[std::size_t(index)], items_[std::size_t(items[0])], trail);
      return;
    }
    const std::size_t first = split(items, kMaxLightTreeDepth - depth);
    const int pair = add_pair(index);
    add(pair, items.first(first), depth + 1, trail);
    add(pair + 1, items.subspan(first), depth + 1, trail | std::uint32_t(LIGHT_CUT) << depth);
  }

  /// Reorders the items and returns how many of them go to the first child. At most `levels` levels may
  /// follow.
  std::size_t split(std::span<int> items, int levels) {
    const bool may_lean = int(std::bit_width(items.size() - 1)) < levels;
    glm::dvec3 low = middle(items[0]), high = low;
    for (const int item : items) {
      low = glm::min(low, middle(item));
      high = glm::max(high, middle(item));
    }
    if (may_lean)
      if (const std::optional<std::size_t> found = best_split(items, low, high)) return *found;
    const glm::dvec3 d = high - low;
    const int axis = d.x >= d.y && d.x >= d.z ? 0 : d.y >= d.z ? 1 : 2;
    std::ranges::sort(items, [&](int a, int b) {
      const double at_a = middle(a)[axis], at_b = middle(b)[axis];
      return at_a != at_b ? at_a < at_b : a < b;
    });
    return items.size() / 2;
  }

  std::optional<std::size_t> best_split(std::span<int> items, const glm::dvec3& low, const glm::dvec3& high) {
    const glm::dvec3 extent = high - low;
    const double longest = std::max({extent.x, extent.y, extent.z});
    double best = std::numeric_limits<double>::infinity();
    int best_axis = -1, best_bucket = 0;
    const auto bucket_of = [&](int item, int axis) {
      return std::min(kBuckets - 1, int((middle(item)[axis] - low[axis]) / extent[axis] * kBuckets));
    };
    for (int axis = 0; axis < 3; ++axis) {
      if (!(extent[axis] > 1e-9 * longest)) continue;
      std::array<std::optional<LightBounds>, kBuckets> buckets;
      for (const int item : items) {
        auto& bucket = buckets[std::size_t(bucket_of(item, axis))];
        bucket = bucket ? joined(*bucket, of(item)) : of(item);
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
      // Penalises thin slabs, which are bad bounds.
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
    for (const int item : items) {
      if (bucket_of(item, best_axis) <= best_bucket)
        items[first++] = item;
      else
        second.push_back(item);
    }
    std::ranges::copy(second, items.begin() + std::ptrdiff_t(first));
    return first;
  }

  static void add_to(std::optional<LightBounds>& sum, const std::optional<LightBounds>& more) {
    if (more) sum = sum ? joined(*sum, *more) : *more;
  }

  std::span<const LightBounds> lights_;
  double unit_;
  std::size_t most_of_cut_;
  std::vector<LightGroup> items_;
  std::vector<LightBounds> bounds_;  ///< of each item
  LightTree tree_;
};

}  // namespace

LightTree build_light_tree(std::span<const LightBounds> lights, double unit,
                           std::span<const LightGroup> groups, int most_of_cut) {
  return TreeBuilder(lights, unit, groups, most_of_cut).build();
}

}  // namespace penumbra
