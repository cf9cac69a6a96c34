#include "scenes/device/light_groups.h"

#include <algorithm>
#include <cmath>

#include "kernels/light/light_tree.h"

namespace penumbra {
namespace {

// Limit on the total increase of the second moment. That moment is 1 if every light is chosen in proportion
// to its possible contribution. The limit is small because well-distributed random numbers make a good choice
// better than its moment says. Measured by light_choice_benchmark: 0.1 costs half of the hierarchy's gain
// with 1000 point lights, and saves another 4 % of the time in spaceship.
constexpr double kMostAdded = 1e-4;
// Limits on vertices times nodes of the hierarchy, that is on the number of bounds computed, which take about
// 15 ns each; and on the number of vertices.
constexpr std::size_t kMostWork = std::size_t{1} << 22, kLeastPlaces = 16, kMostPlaces = 256;

/// Sums for a node over all vertices.
struct NodeSum {
  double share = 0;  ///< how often a traversal reaches it
  double added = 0;  ///< increase of the second moment if its lights were chosen with fixed probabilities
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

  /// Traverses from the root. A node may add no more than its part of the allowed total.
  std::vector<LightGroup> groups() {
    if (weight_ > 0) take(0);
    return std::move(groups_);
  }

 private:
  /// Values at one vertex.
  struct Here {
    double importance, share;
    double light;         ///< possible contribution of all its lights
    double moment;        ///< second moment of traversals from there
    double by_intensity;  ///< sum of (possible contribution of a light)^2 / intensity
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
