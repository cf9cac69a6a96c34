// Which attributes of a mesh the textures of its shape show.
#pragma once

#include "scenes/mesh_reader.h"
#include "scenes/mitsuba/plugin.h"

namespace penumbra::mitsuba {

/// By the textures `mesh_attribute` that the shape's BSDFs and its emitter hold, at any depth. An error where
/// they show two of the vertices, or two of the faces: a mesh has one of each.
MeshAttributeNames mesh_attribute_names(const Context& context, const Object& shape);

}  // namespace penumbra::mitsuba
