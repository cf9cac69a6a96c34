// Subdivision surfaces over triangles (Loop, Smooth Subdivision Surfaces Based on Triangles, 1987).
#pragma once

#include "kernels/host/error.h"
#include "scenes/scene_description.h"

namespace penumbra::pbrt {

/// Subdivides `levels` times and moves the vertices to the limit surface. Only positions and triangles of
/// `mesh` are used, and the result has no normals. Each edge may belong to at most two triangles. Errors: an
/// edge with more; the mesh would exceed the limit on triangles.
Expected<Mesh> loop_subdivided(const Mesh& mesh, int levels);

}  // namespace penumbra::pbrt
