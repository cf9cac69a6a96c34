// Triangle meshes from Wavefront OBJ and Stanford PLY files.
#pragma once

#include "kernels/host/error.h"
#include "scenes/diagnostic.h"
#include "scenes/scene_description.h"

namespace penumbra {

/// Positions, faces (polygons as fans about their first corner), texture coordinates and normals as the file
/// has them, in the file's own space. Corners with the same position, texture and normal index share a
/// vertex; normals and texture coordinates are kept only if every corner has them. Groups, materials, lines
/// and points are passed over. Errors, with line and column: unknown statements, numbers that are none or not
/// finite, indices out of range.
Expected<Mesh> read_obj(const SourceFile& file);

/// The same of a PLY file, ascii or binary of either byte order, whatever the order and types of its
/// properties: x y z, nx ny nz, and u v (or s t, texture_u texture_v) of `vertex`, vertex_indices (or
/// vertex_index) of `face`. Other elements and properties are passed over. Errors: as above (binary: with the
/// vertex's or face's number), a file that ends early.
Expected<Mesh> read_ply(const SourceFile& file);

}  // namespace penumbra
