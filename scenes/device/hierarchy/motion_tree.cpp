#include "scenes/device/hierarchy/motion_tree.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>
#include <vector>

#include "kernels/host/bounds.h"
#include "kernels/intersect/bvh_limits.h"
#include "kernels/math/math.h"
#include "scenes/device/hierarchy/bvh_builder.h"

namespace penumbra {
namespace {

constexpr double kHalfEpsilon = HALF_EPSILON;
constexpr int kMostOfLeaf = BVH_WIDTH;  // primitives; an instance is alone
constexpr int kMostParts = 8;           // parts of the time of a primitive
constexpr int kBins = 16;
constexpr int kDepthOfHalves = 12;  // below it nodes are halved, so that the depth is limited

/// What moves: its boxes at its states, which include all rounding of kernels.
struct Mover {
  int primitive = -1, instance = -1;
  int steps = 0;
  std::size_t first = 0;  ///< index of its first box
};

/// A mover for a part of the time, from one of its states to another.
struct Reference {
  int mover = 0, first_step = 0, last_step = 0;
  Box swept = {};
  float begin = 0, end = 0;
};

void widen(Box& box, double margin) {
  for (int k = 0; k < 3; ++k) {
    box.low[k] = float(box.low[k] - margin);
    box.high[k] = float(box.high[k] + margin);
  }
}

/// Kernels find the step of a time by t * steps, which is rounded, so a time is off by at most half an ulp of
/// `steps`; the position between two states a and b is a + f (b - a), with three roundings. Together that is
/// less than (2 |a| + 2 (steps + 2) |b - a|) 2^-24 along each axis, with the largest of all states.
void add_rounding_of_states(std::span<Box> boxes) {
  double reach = 0, stride = 0;
  for (std::size_t s = 0; s < boxes.size(); ++s)
    for (int k = 0; k < 3; ++k) {
      reach = std::max({reach, std::abs(double(boxes[s].low[k])), std::abs(double(boxes[s].high[k]))});
      if (s == 0) continue;
      stride = std::max({stride, std::abs(double(boxes[s].low[k]) - boxes[s - 1].low[k]),
                         std::abs(double(boxes[s].high[k]) - boxes[s - 1].high[k])});
    }
  const double steps = double(boxes.size() - 1);
  for (Box& box : boxes) widen(box, kHalfEpsilon * (2 * reach + 2 * (steps + 2) * stride));
}

class MotionTreeBuilder {
 public:
  MotionTreeBuilder(SceneRecords& records, double extent) : records_(records), extent_(extent) {
    const Shutter& shutter = records.shutter.front();
    for (std::size_t i = 0; i < records.triangle_motions.size(); ++i)
      add_triangle(shutter.still_triangles + int(i), records.triangle_motions[i]);
    for (std::size_t i = 0; i < records.quadric_motions.size(); ++i)
      add_quadric(int(records.triangles.size()) + shutter.still_quadrics + int(i),
                  records.quadric_motions[i]);
    if (!records.instance_motions.empty())
      for (const PrimitiveGroup& group : records.groups)
        groups_.push_back(group_bounds(records.triangles, records.quadrics, group));
    for (std::size_t i = 0; i < records.instance_motions.size(); ++i)
      add_instance(shutter.still_instances + int(i), records.instance_motions[i]);
  }

  void build() {
    for (std::size_t m = 0; m < movers_.size(); ++m) add_references(int(m));
    if (references_.empty()) return;
    std::vector<int> all(references_.size());
    for (std::size_t i = 0; i < all.size(); ++i) all[i] = int(i);
    add_node(all, 1);
  }

 private:
  Mover& add_mover(int primitive, int instance, int steps) {
    movers_.push_back({primitive, instance, steps, boxes_.size()});
    return movers_.back();
  }
  [[nodiscard]] std::span<Box> boxes_of(const Mover& mover) {
    return std::span(boxes_).subspan(mover.first, std::size_t(mover.steps) + 1);
  }

  void add_triangle(int primitive, const Motion& motion) {
    const Mover& mover = add_mover(primitive, -1, motion.steps);
    double extent = 0;
    for (int s = 0; s <= motion.steps; ++s) {
      const TriangleState& state = records_.triangle_states[std::size_t(motion.first + s * motion.stride)];
      Box box;
      for (const vec3& p : {state.p0, state.p1, state.p2}) box.include(p);
      for (int k = 0; k < 3; ++k) extent = std::max(extent, double(box.high[k]) - box.low[k]);
      boxes_.push_back(box);
    }
    add_rounding_of_states(boxes_of(mover));
    // As hit_margin, but along all axes: the triangle turns.
    for (Box& box : boxes_of(mover)) widen(box, 6 * kHalfEpsilon * extent);
  }

  void add_quadric(int primitive, const Motion& motion) {
    const Mover& mover = add_mover(primitive, -1, motion.steps);
    double bulge = 0;
    const auto state_of = [&](int s) -> const Quadric& {
      return records_.quadric_states[std::size_t(motion.first + s * motion.stride)];
    };
    for (int s = 0; s <= motion.steps; ++s) {
      Quadric q = state_of(s);
      // Between states the unit axis turns on an arc, which the boxes of its chord do not contain.
      if (s > 0 && q.kind == QUADRIC_CYLINDER) {
        const double half = 0.5 * double(length3(sub(q.normal, state_of(s - 1).normal)));
        const double sagitta = 1 - std::sqrt(std::max(1 - half * half, 0.0));
        bulge = std::max(bulge, sagitta * std::max(double(q.length), double(state_of(s - 1).length)));
      }
      Box box = bounds_of(q);
      q.kind = QUADRIC_SPHERE;  // a disk and the ends of a cylinder lie in spheres, however they turn
      const Box first = bounds_of(q);
      if (state_of(s).kind == QUADRIC_CYLINDER) {
        q.center = add_scaled(q.center, q.length, q.normal);
        box.include(bounds_of(q));
      }
      box.include(first);
      boxes_.push_back(box);
    }
    for (Box& box : boxes_of(mover)) widen(box, bulge * (1 + 1e-6));
    add_rounding_of_states(boxes_of(mover));
  }

  void add_instance(int index, const Motion& motion) {
    const Mover& mover = add_mover(-1, index, motion.steps);
    Instance instance = records_.instances[std::size_t(index)];
    const Box& group = groups_[std::size_t(instance.group)];
    double margin = 0;
    for (int s = 0; s <= motion.steps; ++s) {
      const InstanceState& state = records_.instance_states[std::size_t(motion.first + s * motion.stride)];
      instance.x = state.x;
      instance.y = state.y;
      instance.z = state.z;
      instance.at = state.at;
      const vec3 yz = cross3(instance.y, instance.z), zx = cross3(instance.z, instance.x),
                 xy = cross3(instance.x, instance.y);
      const float inverse = 1.0f / dot3(instance.x, yz);
      instance.row_x = scale(yz, inverse);
      instance.row_y = scale(zx, inverse);
      instance.row_z = scale(xy, inverse);
      const PlacedBounds placed = placed_bounds(instance, group, extent_);
      boxes_.push_back(placed.box);
      margin = std::max(margin, placed.margin);
    }
    // The inverse is computed in the kernel, with as many roundings again.
    for (Box& box : boxes_of(mover)) widen(box, margin);
    add_rounding_of_states(boxes_of(mover));
  }

  /// How far the box's centre leaves the straight path from one state to another, and its size.
  [[nodiscard]] std::pair<double, double> bend(std::span<const Box> boxes, int from, int to) const {
    double off = 0, size = 0;
    for (int s = from; s <= to; ++s) {
      const Box &a = boxes[std::size_t(from)], &b = boxes[std::size_t(to)], &box = boxes[std::size_t(s)];
      const double f = double(s - from) / std::max(to - from, 1);
      for (int k = 0; k < 3; ++k) {
        const auto middle = [k](const Box& of) { return 0.5 * (double(of.low[k]) + of.high[k]); };
        off = std::max(off, std::abs(middle(box) - (middle(a) + f * (middle(b) - middle(a)))));
        size = std::max(size, double(box.high[k]) - box.low[k]);
      }
    }
    return {off, size};
  }

  void add_references(int index) {
    const Mover& mover = movers_[std::size_t(index)];
    const std::span<const Box> boxes = boxes_of(mover);
    const int most = mover.instance >= 0 ? mover.steps : std::min(mover.steps, kMostParts);
    int parts = 1;
    for (; parts < most; parts *= 2) {
      bool bends = false;
      const int stride = mover.steps / parts;
      for (int s = 0; s < mover.steps && !bends; s += stride) {
        const auto [off, size] = bend(boxes, s, s + stride);
        bends = off > 0.5 * size;
      }
      if (!bends) break;
    }
    const int stride = mover.steps / parts;
    for (int s = 0; s < mover.steps; s += stride) {
      Reference reference{.mover = index, .first_step = s, .last_step = s + stride};
      for (int k = s; k <= s + stride; ++k) reference.swept.include(boxes[std::size_t(k)]);
      reference.begin = float(s) / float(mover.steps);
      reference.end = float(s + stride) / float(mover.steps);
      references_.push_back(reference);
    }
  }

  struct Bounds4 {
    Box box;
    float begin = std::numeric_limits<float>::infinity(), end = -std::numeric_limits<float>::infinity();
    void include(const Reference& r) {
      box.include(r.swept);
      begin = std::min(begin, r.begin);
      end = std::max(end, r.end);
    }
    void include(const Bounds4& other) {
      box.include(other.box);
      begin = std::min(begin, other.begin);
      end = std::max(end, other.end);
    }
    [[nodiscard]] double cost() const { return begin > end ? 0.0 : half_area(box) * (double(end) - begin); }
  };

  [[nodiscard]] const Reference& of(int index) const { return references_[std::size_t(index)]; }
  [[nodiscard]] const Mover& mover_of(int index) const { return movers_[std::size_t(of(index).mover)]; }
  [[nodiscard]] double middle(int index, int axis) const {
    const Reference& r = of(index);
    return axis < 3 ? 0.5 * (double(r.swept.low[axis]) + r.swept.high[axis])
                    : 0.5 * (double(r.begin) + r.end);
  }
  [[nodiscard]] Bounds4 bounds_of_all(std::span<const int> items) const {
    Bounds4 all;
    for (const int item : items) all.include(of(item));
    return all;
  }
  [[nodiscard]] bool is_leaf(std::span<const int> items) const {
    if (items.size() == 1) return true;
    return items.size() <= std::size_t(kMostOfLeaf) && std::ranges::all_of(items, [&](int item) {
             return mover_of(item).instance < 0 && mover_of(item).steps == mover_of(items[0]).steps &&
                    of(item).first_step == of(items[0]).first_step &&
                    of(item).last_step == of(items[0]).last_step;
           });
  }

  /// Reorders the items and returns how many go first: where boxes, times the time for which they are there,
  /// are smallest.
  [[nodiscard]] std::size_t split(std::span<int> items, bool halves) const {
    std::array<double, 4> low, high;
    low.fill(std::numeric_limits<double>::infinity());
    high.fill(-std::numeric_limits<double>::infinity());
    for (const int item : items)
      for (int axis = 0; axis < 4; ++axis) {
        low[std::size_t(axis)] = std::min(low[std::size_t(axis)], middle(item, axis));
        high[std::size_t(axis)] = std::max(high[std::size_t(axis)], middle(item, axis));
      }
    double least = std::numeric_limits<double>::infinity();
    int best_axis = -1, best_bin = 0;
    const auto bin_of = [&](int item, int axis) {
      const auto a = std::size_t(axis);
      return std::clamp(int((middle(item, axis) - low[a]) / (high[a] - low[a]) * kBins), 0, kBins - 1);
    };
    for (int axis = 0; axis < 4 && !halves; ++axis) {
      if (!(high[std::size_t(axis)] > low[std::size_t(axis)])) continue;
      std::array<Bounds4, kBins> bins;
      std::array<std::size_t, kBins> counts{};
      for (const int item : items) {
        const auto bin = std::size_t(bin_of(item, axis));
        bins[bin].include(of(item));
        ++counts[bin];
      }
      std::array<double, kBins> costs{};
      Bounds4 sum;
      std::size_t count = 0;
      for (std::size_t b = 0; b + 1 < kBins; ++b) {
        sum.include(bins[b]);
        count += counts[b];
        costs[b] = sum.cost() * double(count);
      }
      sum = Bounds4();
      count = 0;
      for (std::size_t b = kBins - 1; b > 0; --b) {
        sum.include(bins[b]);
        count += counts[b];
        costs[b - 1] += sum.cost() * double(count);
        if (count == 0 || count == items.size() || costs[b - 1] >= least) continue;
        least = costs[b - 1];
        best_axis = axis;
        best_bin = int(b) - 1;
      }
    }
    if (best_axis >= 0) {
      std::vector<int> above;
      std::size_t below = 0;
      for (const int item : items) {
        if (bin_of(item, best_axis) <= best_bin)
          items[below++] = item;
        else
          above.push_back(item);
      }
      std::ranges::copy(above, items.begin() + std::ptrdiff_t(below));
      return below;
    }
    int widest = 0;
    for (int axis = 1; axis < 4; ++axis)
      if (high[std::size_t(axis)] - low[std::size_t(axis)] >
          high[std::size_t(widest)] - low[std::size_t(widest)])
        widest = axis;
    std::ranges::sort(items, {}, [&](int item) { return std::pair(middle(item, widest), item); });
    return items.size() / 2;
  }

  int add_leaf(std::span<const int> items) {
    const int at = int(records_.motion_leaves.size());
    const Reference& reference = of(items[0]);
    MotionLeaf leaf{};
    std::fill_n(leaf.primitive, BVH_WIDTH, -1);
    std::fill_n(leaf.instance, BVH_WIDTH, -1);
    for (std::size_t i = 0; i < items.size(); ++i) {
      leaf.primitive[i] = mover_of(items[i]).primitive;
      leaf.instance[i] = mover_of(items[i]).instance;
    }
    leaf.steps = mover_of(items[0]).steps;
    leaf.first_step = reference.first_step;
    leaf.last_step = leaf.instance[0] >= 0 ? reference.first_step : reference.last_step;
    for (int step = leaf.first_step; step <= leaf.last_step; ++step) {
      for (std::size_t i = 0; i < items.size(); ++i) set_vertices(leaf, i, step);
      records_.motion_leaves.push_back(leaf);
    }
    return at;
  }

  /// Empty slots and quadrics keep vertices of 0, which no ray hits.
  void set_vertices(MotionLeaf& leaf, std::size_t slot, int step) const {
    const int triangle = leaf.primitive[slot];
    if (triangle < 0 || triangle >= int(records_.triangles.size())) return;
    const Motion& motion =
        records_.triangle_motions[std::size_t(triangle - records_.shutter.front().still_triangles)];
    const TriangleState& state = records_.triangle_states[std::size_t(motion.first + step * motion.stride)];
    const vec3 corners[3] = {state.p0, state.p1, state.p2};
    for (int v = 0; v < 3; ++v) {
      leaf.p[v][0][slot] = corners[v].x;
      leaf.p[v][1][slot] = corners[v].y;
      leaf.p[v][2][slot] = corners[v].z;
    }
  }

  int add_node(std::span<int> items, int depth) {
    const int at = int(records_.motion_nodes.size());
    records_.motion_nodes.emplace_back();
    std::vector<std::span<int>> parts{items};
    while (parts.size() < std::size_t(BVH_WIDTH)) {
      double most = -1;
      std::size_t largest = 0;
      for (std::size_t i = 0; i < parts.size(); ++i) {
        if (is_leaf(parts[i])) continue;
        const double cost = depth < kDepthOfHalves ? bounds_of_all(parts[i]).cost() : double(parts[i].size());
        if (cost <= most) continue;
        most = cost;
        largest = i;
      }
      if (most < 0) break;
      const std::span<int> part = parts[largest];
      const std::size_t first = split(part, depth >= kDepthOfHalves);
      parts[largest] = part.first(first);
      parts.insert(parts.begin() + std::ptrdiff_t(largest) + 1, part.subspan(first));
    }
    for (int slot = 0; slot < BVH_WIDTH; ++slot) {
      MotionNode made{};
      if (std::size_t(slot) >= parts.size()) {
        set_empty(records_.motion_nodes[std::size_t(at)], slot);
        continue;
      }
      const std::span<int> part = parts[std::size_t(slot)];
      set_box(made, slot, part);
      const int child = is_leaf(part) ? ~add_leaf(part) : add_node(part, depth + 1);
      MotionNode& node = records_.motion_nodes[std::size_t(at)];
      for (int k = 0; k < 3; ++k) {
        node.low[k][slot] = made.low[k][slot];
        node.high[k][slot] = made.high[k][slot];
        node.low_speed[k][slot] = made.low_speed[k][slot];
        node.high_speed[k][slot] = made.high_speed[k][slot];
      }
      node.begin[slot] = made.begin[slot];
      node.end[slot] = made.end[slot];
      node.child[slot] = child;
    }
    return at;
  }

  static void set_empty(MotionNode& node, int slot) {
    const Box none;
    for (int k = 0; k < 3; ++k) {
      node.low[k][slot] = none.low[k];
      node.high[k][slot] = none.high[k];
    }
    node.begin[slot] = 1.0f;
    node.end[slot] = 0.0f;
    node.child[slot] = ~0;
  }

  /// Calls visit(time, box) for all states of the items within their parts of the time.
  void each_state(std::span<const int> items, const auto& visit) {
    for (const int item : items) {
      const Reference& r = of(item);
      const Mover& mover = movers_[std::size_t(r.mover)];
      const std::span<const Box> boxes = boxes_of(mover);
      for (int s = r.first_step; s <= r.last_step; ++s)
        visit(double(s) / mover.steps, boxes[std::size_t(s)], s == r.first_step, s == r.last_step);
    }
  }

  /// Sets the child's linear box: the tightest, at the middle of its time, of a few slopes. Between states
  /// everything is linear, so a box that contains all states contains all.
  void set_box(MotionNode& node, int slot, std::span<const int> items) {
    const Bounds4 all = bounds_of_all(items);
    const double begin = all.begin, end = all.end, duration = std::max(end - begin, 1e-6);
    constexpr int kSlopes = 3;  // none; that from the first box to the last; the mean of all
    std::array<std::array<double, 6>, kSlopes> slopes{};
    {
      Box first, last;
      double time = 0;
      std::array<double, 6> path{}, from{};
      each_state(items, [&](double t, const Box& box, bool is_first, bool is_last) {
        if (t == begin) first.include(box);
        if (t == end) last.include(box);
        for (std::size_t k = 0; k < 6; ++k) {
          const double at = k < 3 ? box.low[k] : box.high[k - 3];
          if (is_first) from[k] = at;
          if (is_last) path[k] += at - from[k];
        }
        time += is_last ? t : is_first ? -t : 0.0;
      });
      for (std::size_t k = 0; k < 6; ++k) {
        const double a = k < 3 ? first.low[k] : first.high[k - 3], b = k < 3 ? last.low[k] : last.high[k - 3];
        slopes[1][k] = std::isfinite(a) && std::isfinite(b) ? (b - a) / duration : 0.0;
        slopes[2][k] = time > 0 ? path[k] / time : 0.0;
      }
    }
    std::array<std::array<double, 6>, kSlopes> offsets;
    for (auto& offset : offsets) offset.fill(std::numeric_limits<double>::infinity());
    each_state(items, [&](double t, const Box& box, bool, bool) {
      for (int c = 0; c < kSlopes; ++c)
        for (std::size_t k = 0; k < 6; ++k) {
          const double value = k < 3 ? box.low[k] : -double(box.high[k - 3]);
          const double slope = k < 3 ? slopes[std::size_t(c)][k] : -slopes[std::size_t(c)][k];
          offsets[std::size_t(c)][k] = std::min(offsets[std::size_t(c)][k], value - slope * t);
        }
    });
    const double middle = 0.5 * (begin + end);
    for (std::size_t k = 0; k < 6; ++k) {
      std::size_t best = 0;
      const auto at_middle = [&](std::size_t c) {
        return offsets[c][k] + (k < 3 ? slopes[c][k] : -slopes[c][k]) * middle;
      };
      for (std::size_t c = 1; c < kSlopes; ++c)
        if (at_middle(c) > at_middle(best)) best = c;
      // The product, the sum and the stored numbers are rounded: at most 4 roundings of either.
      const double slope = slopes[best][k];
      const double offset =
          offsets[best][k] - 4 * kHalfEpsilon * (std::abs(offsets[best][k]) + std::abs(slope));
      const float infinity = std::numeric_limits<float>::infinity();
      if (k < 3) {
        node.low[k][slot] = std::nextafter(float(offset), -infinity);
        node.low_speed[k][slot] = float(slope);
      } else {
        node.high[k - 3][slot] = std::nextafter(float(-offset), infinity);
        node.high_speed[k - 3][slot] = float(slope);
      }
    }
    // A time at which a part ends is in the next one.
    node.begin[slot] = all.begin;
    node.end[slot] = all.end < 1 ? std::nextafter(all.end, 0.0f) : all.end;
  }

  SceneRecords& records_;
  const double extent_;
  std::vector<Box> groups_;
  std::vector<Mover> movers_;
  std::vector<Box> boxes_;
  std::vector<Reference> references_;
};

}  // namespace

void add_motion_tree(SceneRecords& records, double extent) { MotionTreeBuilder(records, extent).build(); }

}  // namespace penumbra
