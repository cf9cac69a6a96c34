// Shapes from files that are not triangle meshes and are converted to triangles.
#pragma once

#include "scenes/mitsuba/plugin.h"
#include "scenes/mitsuba/shape_parameters.h"

namespace penumbra::mitsuba {

struct TessellatedShape {
  Mesh mesh;
  glm::dmat4 to_world{1.0};  ///< the part of the shape's transform that is still to be applied
};

/// Curves in world space. Errors: those of the file's reader; points too far away.
Expected<Curves> curves_of(const BsplineCurveShape& shape, const SourceFile& file);
Expected<Curves> curves_of(const LinearCurveShape& shape, const SourceFile& file);

/// Errors: those of the file's reader; the mesh would exceed the limit on triangles; points too far away.
Expected<TessellatedShape> tessellated(const PluginReader& plugin, const BsplineCurveShape& shape,
                                       const SourceFile& file);
Expected<TessellatedShape> tessellated(const PluginReader& plugin, const LinearCurveShape& shape,
                                       const SourceFile& file);
Expected<TessellatedShape> tessellated(const PluginReader& plugin, const SdfGridShape& shape,
                                       const SourceFile& file);

}  // namespace penumbra::mitsuba
