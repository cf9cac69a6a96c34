// Difficult scenes for the closed form on the screen.
#pragma once

#include "scenes/scene_description.h"

namespace penumbra {

/// Of a camera.
glm::dmat4 look_at(glm::dvec3 eye, glm::dvec3 target, glm::dvec3 up);

/// Spheres from outside and inside, a disk, a mesh with vertex normals, a light that shines to both sides
/// over them, an environment.
SceneDescription round_things();

/// The same with surfaces that have control lobes: conductors, plastics, principled.
SceneDescription round_lobes();

/// A coarse mesh with vertex normals, which face away from the camera at its rims, and a light over it.
SceneDescription coarse_rims();

/// Everything `factor` times as large.
SceneDescription scaled(SceneDescription scene, double factor);

/// The Cornell box with lobes of low and high, whole and broken exponents.
SceneDescription glossy_box();

/// Strips of a floor with lobes of all kinds, close under lights that partly go through the floor's plane.
SceneDescription strips();

/// On a ground so large that the rest of the scene is small.
SceneDescription on_a_plain();

}  // namespace penumbra
