#include "scenes/device/light_groups.h"

#include <algorithm>
#include <cmath>

#include "kernels/light/light_tree.h"

namespace penumbra {
namespace {

// To the second moment, in all; that is 1 where each light is taken for what it may contribute. Little, since
// well spread numbers make of a good choice more than its moment says: measured by light_choice_benchmark,
// 0.1 costs half of what the hierarchy gains with 1000 point lights, and saves another 4 % of the time in
// spaceship.
constexpr double kMostAdded = 1e-4;
// Times nodes of the hierarchy: how often a bound is computed. That takes some 15 ns.
constexpr std::size_t kMostWork = std::size_t{1} << 22, kLeastPlaces = 16, kMostPlaces = 256;

/// Of a node, over all places.
struct NodeSum {
  double share = 0;  ///< how often a walk gets there
  double added = 0;  ///< to the second moment if its lights kept their shares
};

class Grouping {
 public:
  Grouping(const LightTree& tree, std::span<const LightBounds> lights)
      : tree_(tree), sums_(tree.nodes.size()), here_(tree.nodes.size()), intensity_(tree.nodes.size()) {
    for (std::size_t i = tree.nodes.size(); i-- > 0;) {
      const int child = tree.nodes[i].child;
      intensity_[i] = child < 0 ? lights[std::size_t(~child)].intensity
                                : intensity_[std::size_t(child)] + intensity_[std::size_t(child) + 1];
    }
  }

  void visit(const PilotVertex& place) {
    LitPlace lit;
    lit.p = place.p;
    lit.facing = place.facing;
    for (std::size_t i = tree_.nodes.size(); i-- > 0;) {
      const LightNode& node = tree_.nodes[i];
      Here& h = here_[i];
      h.importance = double(light_importance(&node, lit));
      if (node.child < 0) {
        h.light = h.importance;
        h.moment = h.light * h.light;
        h.by_intensity = h.moment / intensity_[i];
        continue;
      }
      const Here &a = here_[std::size_t(node.child)], &b = here_[std::size_t(node.child) + 1];
      h.light = a.light + b.light;
      h.by_intensity = a.by_intensity + b.by_intensity;
      const double both = a.importance + b.importance;
      h.moment = (a.importance > 0 ? a.moment * both / a.importance : 0) +
                 (b.importance > 0 ? b.moment * both / b.importance : 0);
    }
    const double all = here_[0].light;
    if (!(all > 0)) return;
    weight_ += place.weight;
    here_[0].share = 1;
    for (std::size_t i = 0; i < tree_.nodes.size(); ++i) {
      const Here& h = here_[i];
      const int child = tree_.nodes[i].child;
      if (h.share > 0) {
        const double kept = h.by_intensity * intensity_[i];
        sums_[i].share += place.weight * h.share;
        sums_[i].added += place.weight * (kept - h.moment) / (h.share * all * all);
      }
      if (child < 0) continue;
      Here &a = here_[std::size_t(child)], &b = here_[std::size_t(child) + 1];
      const double both = a.importance + b.importance;
      a.share = both > 0 ? h.share * a.importance / both : 0;
      b.share = both > 0 ? h.share * b.importance / both : 0;
    }
  }

  /// From the root on: a node adds no more than its part of what all may add.
  std::vector<LightGroup> groups() {
    if (weight_ > 0) take(0);
    return std::move(groups_);
  }

 private:
  /// At one place.
  struct Here {
    double importance, share;
    double light;         ///< that all its lights may contribute
    double moment;        ///< of walks from there
    double by_intensity;  ///< sum of (what a light may contribute)^2 / intensity
  };

  void collect(std::size_t node, LightGroup& group) const {
    const int child = tree_.nodes[node].child;
    if (child < 0) {
      group.push_back(~child);
      return;
    }
    collect(std::size_t(child), group);
    collect(std::size_t(child) + 1, group);
  }

  void take(std::size_t node) {
    const int child = tree_.nodes[node].child;
    if (child < 0) return;
    if (sums_[node].added <= kMostAdded * sums_[node].share) {
      LightGroup group;
      collect(node, group);
      if (group.size() <= kMostOfLeaf) {
        groups_.push_back(std::move(group));
        return;
      }
    }
    take(std::size_t(child));
    take(std::size_t(child) + 1);
  }

  const LightTree& tree_;
  std::vector<NodeSum> sums_;
  std::vector<Here> here_;
  std::vector<double> intensity_;
  std::vector<LightGroup> groups_;
  double weight_ = 0;
};

}  // namespace

std::vector<LightGroup> light_groups(std::span<const LightBounds> lights, double unit,
                                     std::span<const PilotVertex> places) {
  std::vector<LightBounds> finite(lights.begin(), lights.end());
  for (LightBounds& light : finite)
    if (light.infinite) light.intensity = 0;
  const LightTree tree = build_light_tree(finite, unit, {}, 1);
  if (tree.nodes.size() < 2 || places.empty()) return {};
  Grouping grouping(tree, finite);
  const std::size_t wanted = std::clamp(kMostWork / tree.nodes.size(), kLeastPlaces, kMostPlaces);
  const std::size_t count = std::min(places.size(), wanted);
  for (std::size_t k = 0; k < count; ++k) grouping.visit(places[k * places.size() / count]);
  return grouping.groups();
}

}  // namespace penumbra
