// The camera as image files describe it to other programs.
#pragma once

#include "scenes/scene_description.h"
#include "scheduler/image/image.h"

namespace penumbra {

/// The transforms from world to camera and to the film, of the pinhole: a lens, distortion and chromatic
/// aberration cannot be expressed by a matrix, and panoramas have none to the film. Depth in NDC runs from 0
/// at the near to 1 at the far clipping plane. The format has single precision, so scenes far from the origin
/// lose digits.
ImageCamera camera_attributes(const CameraSettings& camera, const Film& film);

}  // namespace penumbra
