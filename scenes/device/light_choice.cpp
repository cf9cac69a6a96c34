#include "scenes/device/light_choice.h"

#include <algorithm>
#include <glm/glm.hpp>
#include <optional>
#include <vector>

#include "kernels/host/device_scene.h"
#include "scenes/device/integrator_builder.h"
#include "scenes/device/intersector.h"
#include "scenes/device/light_groups.h"
#include "scenes/device/light_table.h"
#include "scenes/device/light_tree_builder.h"
#include "scenes/device/pilot_paths.h"

namespace penumbra {
namespace {

class Chooser {
 public:
  Chooser(std::span<const LightBounds> lights, bool open, double radius, SceneHeader& header,
          SceneRecords& records, TemporaryHierarchy& hierarchy)
      : lights_(lights), open_(open), radius_(radius), h_(header), records_(records), hierarchy_(hierarchy) {}

  /// The weight of infinite lights relative to the others is found by tracing pilot paths through the scene.
  Expected<void> add() {
    std::vector<LightBounds> all(lights_.begin(), lights_.end()), finite = all;
    std::vector<int> infinite;
    double intensity = 0;
    for (std::size_t i = 0; i < all.size(); ++i) {
      if (all[i].infinite && all[i].intensity > 0) infinite.push_back(int(i));
      if (all[i].infinite) finite[i].intensity = 0;
      intensity += finite[i].intensity;
    }
    const double size2 = std::clamp(radius_ * radius_, 1e-30, 1e30);
    const double unit = intensity > 0 ? size2 / intensity : 1.0;
    if (infinite.empty() || !(intensity > 0)) {
      const bool alike = infinite.empty() && in_one_place(all) && open_;
      if (alike) {
        set_light_tree({});
        return {};
      }
      const Expected<std::vector<LightGroup>> groups = groups_of(finite, unit);
      if (!groups) return std::unexpected(groups.error());
      set_light_tree(build_light_tree(all, unit, *groups));
      return {};
    }
    const Expected<std::vector<LightGroup>> groups = groups_of(finite, unit);
    if (!groups) return std::unexpected(groups.error());
    set_light_tree(build_light_tree(finite, unit, *groups));
    InfiniteLights found{.intensities = std::vector<double>(infinite.size(), 1.0)};
    Expected<void> done = with_pilot_scene([&] { found = weigh_infinite_lights(h_, records_, infinite); });
    if (!done) return done;
    if (infinite.size() == 1 && in_one_place(finite) && open_) {
      choose_alike(infinite[0], found.share);
      return {};
    }
    for (std::size_t i = 0; i < infinite.size(); ++i)
      all[std::size_t(infinite[i])].intensity = found.intensities[i] / unit;
    set_light_tree(build_light_tree(all, unit, *groups));
    return {};
  }

 private:
  /// Without lights if none has power.
  void set_light_tree(const LightTree& tree) {
    if (tree.nodes.empty()) {
      h_.light_cut = h_.light_tree_depth = 0;
      h_.integrator.light_choice = CHOICE_POWER;
      h_.features &= ~std::uint64_t(FEATURE_LIGHT_TREE);
      return;
    }
    records_.light_nodes = tree.nodes;
    records_.light_trails = tree.trails;
    records_.light_members = tree.members;
    records_.light_numbers = tree.numbers;
    h_.light_cut = tree.cut;
    h_.light_tree_depth = tree.depth;
    h_.light_leaf_steps = tree.leaf_turns;
  }

  /// Whether these lights are close together, like the triangles of one light.
  static bool in_one_place(const std::vector<LightBounds>& lights) {
    constexpr int kMost = 4;
    const auto size = [](const LightBounds& b) { return glm::length(b.high - b.low); };
    std::optional<LightBounds> all;
    double largest = 0;
    int count = 0;
    for (const LightBounds& light : lights) {
      if (!(light.intensity > 0)) continue;
      all = all ? joined(*all, light) : light;
      largest = std::max(largest, size(light));
      if (++count > kMost) return false;
    }
    return all && size(*all) <= 1.01 * largest;
  }

  /// For an infinite light and a cluster of close lights only the probability of each matters, not where the
  /// shading point is. The table suffices and takes no time.
  void choose_alike(int infinite, double share) {
    std::vector<double> shares;
    double intensity = 0;
    for (const LightBounds& light : lights_) intensity += light.infinite ? 0.0 : light.intensity;
    for (const LightBounds& light : lights_)
      shares.push_back(light.infinite ? 0.0 : (1 - share) * light.intensity / intensity);
    shares[std::size_t(infinite)] = share;
    records_.light_cells = set_light_probabilities(records_.lights, shares, lights_);
    set_light_tree({});
    records_.light_nodes.clear();
    records_.light_trails.clear();
    records_.light_members.clear();
    records_.light_numbers.clear();
  }

  /// Light clusters (see light_groups) of at least two finite lights.
  Expected<std::vector<LightGroup>> groups_of(const std::vector<LightBounds>& finite, double unit) {
    if (std::ranges::count_if(finite, [](const LightBounds& b) { return b.intensity > 0; }) < 2)
      return std::vector<LightGroup>{};
    std::vector<PilotVertex> places;
    if (Expected<void> done = with_pilot_scene([&] { places = pilot_vertices(h_, records_); }); !done)
      return std::unexpected(done.error());
    return light_groups(finite, unit, places);
  }

  /// Calls `look` with the scene, which has the portable hierarchy meanwhile. Does nothing for a scene
  /// without primitives.
  template <typename Look>
  Expected<void> with_pilot_scene(const Look& look) {
    if (records_.triangles.empty() && records_.quadrics.empty()) return {};
    if (Expected<void> done = hierarchy_.need(); !done) return done;
    look();
    return {};
  }

  std::span<const LightBounds> lights_;
  bool open_;  ///< whether the settings leave the choice of lights to the renderer
  double radius_;
  SceneHeader& h_;
  SceneRecords& records_;
  TemporaryHierarchy& hierarchy_;
};

}  // namespace

Expected<void> add_light_tree(std::span<const LightBounds> bounds, const IntegratorSettings& integrator,
                              double scene_radius, SceneHeader& header, SceneRecords& records,
                              TemporaryHierarchy& hierarchy) {
  return Chooser(bounds, light_choice_is_auto(integrator), scene_radius, header, records, hierarchy).add();
}

}  // namespace penumbra
