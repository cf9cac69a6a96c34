// BSDFs of a scene as the kernels' materials.
#pragma once

#include <cstdint>

#include "kernels/scene_types.h"
#include "scenes/scene_description.h"

namespace penumbra {

struct BuiltMaterial {
  Material material;
  std::uint32_t features = 0;  ///< FEATURE_* bits that it needs
};

BuiltMaterial build_material(const Bsdf& bsdf);

}  // namespace penumbra
