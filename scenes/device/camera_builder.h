// A scene's camera as the kernels' one.
#pragma once

#include "kernels/scene_types.h"
#include "scenes/scene_description.h"

namespace penumbra {

/// `origin`: where it is, in the coordinates of the device scene.
Camera build_camera(const PerspectiveCamera& camera, const Film& film, const vec3& origin);

}  // namespace penumbra
