// BSDFs of a scene as the kernels' materials.
#pragma once

#include "kernels/scene_types.h"
#include "scenes/scene_description.h"

namespace penumbra {

Material build_material(const Bsdf& bsdf);

}  // namespace penumbra
