// Reads [camera] and [film] of a TinyRender scene.
#pragma once

#include "scenes/tinyrender/section.h"

namespace penumbra::tinyrender {

/// Reads a perspective camera at `eye` that looks at `at`. `up` points into the upper half of the image.
/// `fov` is the vertical full angle of view in degrees.
void read_camera(const Context& context, SceneDescription& scene);

/// Reads the image size. The filter is a box of one pixel.
void read_film(const Context& context, SceneDescription& scene);

}  // namespace penumbra::tinyrender
