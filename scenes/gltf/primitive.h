// Primitives of glTF's meshes as triangles.
#pragma once

#include "scenes/gltf/primitive_attributes.h"
#include "scenes/scene_description.h"

namespace penumbra::gltf {

/// The triangles of a primitive in the mesh's own space: of lists, strips and fans, with indices or without.
/// `texcoord` is the set of texture coordinates that counts; -1: the first. Normals as the file has them,
/// none where it has none. Errors: see read_accessor; indices beyond the vertices, attributes of other
/// counts.
Expected<Mesh> read_primitive(const PrimitiveAttributes& attributes, int mode, int texcoord);

/// Whether it is made of triangles, and not of points or lines.
bool is_surface(const tinygltf::Primitive& primitive);

}  // namespace penumbra::gltf
