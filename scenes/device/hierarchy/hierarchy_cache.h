// A cache of hierarchies on disk. Building one takes longer than reading all files of a large scene, and
// renders with other cameras, materials, lights or settings share it.
#pragma once

#include <cstdint>
#include <filesystem>

#include "kernels/host/checked_cache.h"
#include "scenes/device/hierarchy/bvh_builder.h"

namespace penumbra {

/// Least recently used hierarchies beyond this are removed. A million triangles have 15 to 30 MB.
constexpr std::uint64_t kHierarchyCacheBytes = std::uint64_t(2) << 30;

/// The folder: PENUMBRA_HIERARCHY_CACHE (off: none), else penumbra/hierarchies in the user's cache.
std::filesystem::path default_hierarchy_cache();

class HierarchyCache {
 public:
  /// Below so many primitives, building takes less than 0.1 s.
  static constexpr std::size_t kFewestPrimitives = 20'000;

  /// With an empty folder every hierarchy is built.
  explicit HierarchyCache(std::filesystem::path folder, std::size_t fewest_primitives = kFewestPrimitives);

  /// What build_hierarchy returns for that, byte for byte. Where something is still, only its part is kept. A
  /// folder that cannot be written, and a damaged file, only cost the time of building.
  [[nodiscard]] Expected<Hierarchy> find_or_build(const HierarchyInput& input) const;

 private:
  [[nodiscard]] Expected<Hierarchy> find_or_build_part(const HierarchyInput& input) const;

  CheckedCache files_;
  std::size_t fewest_primitives_;
};

}  // namespace penumbra
