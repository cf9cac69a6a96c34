#pragma once
#include <cstdint>

#include "kernels/bsdf/families.h"
#include "kernels/features.h"

namespace penumbra {

/// The name, for users, of a bit of a scene's features, BSDF families or kinds of lights.
struct NamedBit {
  std::uint64_t bit;
  const char *name, *description;
};
#define LIST_FEATURE(name, description) {FEATURE_##name, #name, description},
inline constexpr NamedBit kFeatures[] = {PENUMBRA_FEATURES(LIST_FEATURE)};
#undef LIST_FEATURE
#define LIST_FAMILY(name, NAME, number, properties, description) {1u << (number), "BSDF_" #NAME, description},
inline constexpr NamedBit kFamilies[] = {BSDF_FAMILIES(LIST_FAMILY)};
#undef LIST_FAMILY

}  // namespace penumbra
