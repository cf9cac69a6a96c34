// [camera] and [film] of a TinyRender scene.
#pragma once

#include "scenes/tinyrender/section.h"

namespace penumbra::tinyrender {

/// A perspective camera at `eye` that sees `at`, with `up` in its upper half plane and `fov` degrees from the
/// lower to the upper edge of the picture.
void read_camera(const Context& context, SceneDescription& scene);

/// The size of the picture. Its samples count for the pixel that they lie in, with equal weight.
void read_film(const Context& context, SceneDescription& scene);

}  // namespace penumbra::tinyrender
