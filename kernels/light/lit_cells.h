// Surfaces that see every light whole: what samples of lights would bring there is known, without shadow rays
// and without noise. The host divides what the camera sees of triangles into cells, and marks those from all
// of whose points nothing is between them and any light (scenes/device/lit_cells.h). Where a scene has such
// cells, all of its lights are polygons.
#ifndef PENUMBRA_LIT_CELLS_H
#define PENUMBRA_LIT_CELLS_H
#include "kernels/intersect/surface.h"
#include "kernels/scene.h"

PENUMBRA_NAMESPACE_BEGIN

#if HAS(LIT_CELLS)
/// The cell along one way, of `side`.
FN int lit_cell_along(vec3 row, float at, vec3 p, int side) {
  const float share = dot3(row, p) + at;
  return min_i((int)((share > 0.0f ? min_f(share, 1.0f) : 0.0f) * (float)side), side - 1);
}

/// Whether the surface is in such a cell.
FN bool sees_lights_whole(const PRIVATE Scene* scene, Surface s) {
  const int count = scene->header.tables.lit_faces.count;
  const bool is_face = (s.primitive >= 0) & (s.primitive < count);
  GLOBAL const LitFace* face = scene->lit_faces + (is_face ? s.primitive : 0);
  const bool has_cells = is_face & (face->level >= 0) & (s.front == (face->front != 0));
  const int level = has_cells ? face->level : 0, side = 1 << level;
  const int x = lit_cell_along(load3(&face->row_x), face->at_x, s.p, side);
  const int y = lit_cell_along(load3(&face->row_y), face->at_y, s.p, side);
  const int cell = (y << level) + x;
  const uint word = scene->lit_cells[has_cells ? face->first + (cell >> 5) : 0];
  return has_cells & ((word >> (uint)(cell & 31) & 1u) != 0u);
}
#endif

PENUMBRA_NAMESPACE_END
#endif
