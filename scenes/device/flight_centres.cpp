#include "scenes/device/flight_centres.h"

#include <algorithm>
#include <utility>

#include "scenes/device/to_vec3.h"

namespace penumbra {
namespace {

// Each group costs a multiplication and a comparison per flight. With more groups, the chosen one is rarely
// the one whose light a path then samples.
constexpr std::size_t kMostGroups = 16;

glm::dvec3 middle(const LightBounds& b) { return 0.5 * (b.low + b.high); }

struct Group {
  std::vector<LightBounds> lights;
  LightBounds all;
  glm::dvec3 low, high;  ///< bounding box of the lights' centres

  explicit Group(std::vector<LightBounds> members) : lights(std::move(members)), all(lights.front()) {
    low = high = middle(all);
    for (std::size_t i = 1; i < lights.size(); ++i) {
      all = joined(all, lights[i]);
      low = glm::min(low, middle(lights[i]));
      high = glm::max(high, middle(lights[i]));
    }
  }

  /// An estimate of the gain from splitting the group.
  [[nodiscard]] double spread() const { return all.intensity * glm::length(high - low); }
};

/// Splits at the middle of the longest side of the group's box, so that clusters stay together.
std::pair<Group, Group> parted(const Group& group) {
  const glm::dvec3 size = group.high - group.low;
  const int axis = size.x >= size.y && size.x >= size.z ? 0 : (size.y >= size.z ? 1 : 2);
  const double border = group.low[axis] + 0.5 * size[axis];
  std::vector<LightBounds> below, above;
  for (const LightBounds& light : group.lights)
    (middle(light)[axis] <= border ? below : above).push_back(light);
  return {Group(std::move(below)), Group(std::move(above))};
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
    // Stop if the box is so small that its middle equals one of its ends.
    if (!(widest->spread() > 1e-6 * widest->all.intensity * glm::length(widest->all.high + widest->all.low)))
      break;
    auto [first, second] = parted(*widest);
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
