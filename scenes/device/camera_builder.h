// Converts a scene's camera to the kernels' camera.
#pragma once

#include <cstdint>

#include "kernels/scene_types.h"
#include "scenes/scene_description.h"

namespace penumbra {

/// The kernels' camera. `origin` is its position in the coordinates of the device scene. The camera must have
/// passed check_camera.
Camera build_camera(const CameraSettings& camera, const Film& film, const vec3& origin);

/// FEATURE_CAMERA for a camera that is not a plain pinhole, and FEATURE_PANORAMA for a panoramic one; else 0.
std::uint64_t camera_features(const CameraSettings& camera);

}  // namespace penumbra
