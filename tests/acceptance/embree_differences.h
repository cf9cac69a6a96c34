// Where Embree and the portable intersector find different primitives, and why.
#pragma once

#include <array>
#include <cstdint>
#include <set>
#include <string_view>
#include <utility>
#include <vector>

#include "kernels/host/device_scene.h"
#include "worker/device.h"

namespace penumbra {

/// Why two correct intersectors may differ. Rounding is what their arithmetic in single precision can err by,
/// see embree_differences.cpp; truth is the exact position of ray and triangle in 113 bits.
enum class DifferenceCause {
  kSharedEdge,   ///< one passes within rounding of an edge of the primitives hit, at the same distance
  kCoincident,   ///< two surfaces lie at the same distance within rounding: a tie
  kSilhouette,   ///< within rounding of an edge, behind which the other one goes on
  kRayEnd,       ///< the primitive is within rounding of where the ray begins or ends
  kUnexplained,  ///< none of these: a bug in either
};
constexpr int kDifferenceCauses = int(DifferenceCause::kUnexplained) + 1;
std::string_view cause_name(DifferenceCause cause);

struct EmbreeDifferences {
  std::uint64_t rays = 0;  ///< camera rays, bounces and shadow rays
  std::array<std::uint64_t, kDifferenceCauses> by_cause{};
  std::set<std::pair<int, int>> pixels;  ///< that have such a ray
  std::vector<std::string> examples;     ///< one for each cause, with the numbers

  [[nodiscard]] std::uint64_t total() const;
};

/// Renders the whole film with Embree and lets the portable intersector look at each ray too. The scene is
/// built for Embree; its primitives are tested one by one.
EmbreeDifferences find_embree_differences(const DeviceScene& scene, Isa isa);

}  // namespace penumbra
