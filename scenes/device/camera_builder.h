// A scene's camera as the kernels' one.
#pragma once

#include <cstdint>

#include "kernels/scene_types.h"
#include "scenes/scene_description.h"

namespace penumbra {

/// `origin`: where it is, in the coordinates of the device scene. Of a camera that check_camera accepts.
Camera build_camera(const CameraSettings& camera, const Film& film, const vec3& origin);

/// FEATURE_CAMERA for one that is more than a pinhole, or 0.
std::uint64_t camera_features(const CameraSettings& camera);

}  // namespace penumbra
