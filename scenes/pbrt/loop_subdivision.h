// Subdivision surfaces of triangles (Loop, Smooth Subdivision Surfaces Based on Triangles, 1987).
#pragma once

#include "kernels/host/error.h"
#include "scenes/scene_description.h"

namespace penumbra::pbrt {

/// The mesh of so many levels, its vertices moved onto the limit surface, without normals. Of `mesh`
/// positions and triangles count, each edge of at most two triangles. Errors: an edge of more; more triangles
/// than are made.
Expected<Mesh> loop_subdivided(const Mesh& mesh, int levels);

}  // namespace penumbra::pbrt
