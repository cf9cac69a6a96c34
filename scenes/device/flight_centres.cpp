#include "scenes/device/flight_centres.h"

#include <algorithm>
#include <tuple>
#include <utility>

#include "scenes/device/to_vec3.h"

namespace penumbra {
namespace {

// A group takes a multiplication and a comparison of each flight; with more than so many lamps the one that
// is chosen is seldom that which a path finds.
constexpr std::size_t kMostGroups = 16;

glm::dvec3 middle(const LightBounds& b) { return 0.5 * (b.low + b.high); }

struct Group {
  std::vector<LightBounds> lights;
  LightBounds all;

  explicit Group(std::vector<LightBounds> members) : lights(std::move(members)), all(lights.front()) {
    for (std::size_t i = 1; i < lights.size(); ++i) all = joined(all, lights[i]);
  }

  /// How much there is to be gained by parting it.
  [[nodiscard]] double spread() const {
    return lights.size() > 1 ? all.intensity * glm::length(all.high - all.low) : 0.0;
  }
};

/// About the median along its longest side.
std::pair<Group, Group> parted(Group group) {
  const glm::dvec3 size = group.all.high - group.all.low;
  const int axis = size.x >= size.y && size.x >= size.z ? 0 : (size.y >= size.z ? 1 : 2);
  std::ranges::sort(group.lights, {}, [&](const LightBounds& b) {
    const glm::dvec3 at = middle(b);
    return std::tuple(at[axis], at.x, at.y, at.z, b.intensity);
  });
  const auto half = group.lights.begin() + std::ptrdiff_t(group.lights.size() / 2);
  return {Group({group.lights.begin(), half}), Group({half, group.lights.end()})};
}

}  // namespace

std::vector<FlightCentre> flight_centres(std::span<const LightBounds> lights) {
  std::vector<LightBounds> somewhere;
  for (const LightBounds& light : lights)
    if (!light.infinite && light.intensity > 0) somewhere.push_back(light);
  if (somewhere.empty()) return {};
  std::vector<Group> groups{Group(std::move(somewhere))};
  while (groups.size() < kMostGroups) {
    const auto widest = std::ranges::max_element(groups, {}, &Group::spread);
    if (!(widest->spread() > 0)) break;
    auto [first, second] = parted(std::move(*widest));
    *widest = std::move(first);
    groups.push_back(std::move(second));
  }
  double whole = 0, so_far = 0;
  for (const Group& group : groups) whole += group.all.intensity;
  std::vector<FlightCentre> centres;
  for (const Group& group : groups) {
    so_far += group.all.intensity;
    FlightCentre centre{};
    centre.place = to_vec3(middle(group.all));
    centre.size = float(0.25 * glm::length(group.all.high - group.all.low));
    centre.below = float(so_far / whole);
    centres.push_back(centre);
  }
  return centres;
}

}  // namespace penumbra
