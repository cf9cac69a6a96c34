// Converts glTF primitives to triangles.
#pragma once

#include "scenes/gltf/primitive_attributes.h"
#include "scenes/reader_report.h"
#include "scenes/scene_description.h"

namespace penumbra::gltf {

/// The triangles of a primitive in the mesh's own space. The mode may be list, strip or fan, with or without
/// indices. `texcoord` selects the set of texture coordinates; -1: the first. The mesh has normals only if
/// the file has. Errors: those of read_accessor; indices beyond the vertices; attributes of different counts.
Expected<Mesh> read_primitive(const PrimitiveAttributes& attributes, int mode, int texcoord);

/// Warns of vertex colours whose alpha would make the material transparent, which is ignored.
void warn_of_opacity(const Asset& asset, const tinygltf::Primitive& primitive, SourceLocation location,
                     ReaderReport& report);

/// Whether the primitive consists of triangles, not points or lines.
bool is_surface(const tinygltf::Primitive& primitive);

}  // namespace penumbra::gltf
