// A scene of any number of triangles for timing intersectors.
#pragma once

#include "scenes/scene_description.h"

namespace penumbra {

/// A closed room of 12 triangles with a square light below its ceiling and in its middle a ball with bumps of
/// `ball_triangles` triangles (rounded down to a grid), seen from inside, path traced.
SceneDescription bumpy_room(int ball_triangles);

}  // namespace penumbra
