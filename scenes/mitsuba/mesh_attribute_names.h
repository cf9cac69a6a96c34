// Finds the mesh attributes that the textures of a shape use.
#pragma once

#include "scenes/mesh_reader.h"
#include "scenes/mitsuba/plugin.h"

namespace penumbra::mitsuba {

/// The attributes used by `mesh_attribute` textures nested at any depth in the shape's BSDFs and emitter. It
/// is an error if they use two different vertex attributes or two different face attributes, because a mesh
/// stores only one of each.
MeshAttributeNames mesh_attribute_names(const Context& context, const Object& shape);

}  // namespace penumbra::mitsuba
