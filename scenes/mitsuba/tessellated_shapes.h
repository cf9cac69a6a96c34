// Shapes of files that are no triangles, and become some.
#pragma once

#include "scenes/mitsuba/plugin.h"
#include "scenes/mitsuba/shape_parameters.h"

namespace penumbra::mitsuba {

struct TessellatedShape {
  Mesh mesh;
  glm::dmat4 to_world{1.0};  ///< what is left of the shape's own
};

/// Errors: what the file's reader says; more triangles than are made; points too far away.
Expected<TessellatedShape> tessellated(const PluginReader& plugin, const BsplineCurveShape& shape,
                                       const SourceFile& file);
Expected<TessellatedShape> tessellated(const PluginReader& plugin, const LinearCurveShape& shape,
                                       const SourceFile& file);
Expected<TessellatedShape> tessellated(const PluginReader& plugin, const SdfGridShape& shape,
                                       const SourceFile& file);

}  // namespace penumbra::mitsuba
