// The camera as image files tell it to other programs.
#pragma once

#include "scenes/scene_description.h"
#include "scheduler/image/image.h"

namespace penumbra {

/// World to camera and to the film, of the pinhole: a lens, distortion and the images of red and blue are
/// left out, as no matrix has them. Depth in NDC runs from 0 at the near to 1 at the far clipping plane.
/// Single precision is the format's: scenes far from their origin lose digits there.
ImageCamera camera_attributes(const CameraSettings& camera, const Film& film);

}  // namespace penumbra
