#include "scenes/mitsuba/tessellated_shapes.h"

#include <fmt/format.h>

#include <cmath>

#include "scenes/curve_mesh.h"
#include "scenes/sdf_grid.h"
#include "scenes/traceable.h"
#include "scenes/transform.h"

namespace penumbra::mitsuba {
namespace {

/// Only the points are transformed to world space; radii are not scaled.
Expected<Curves> curves(CurveForm form, const glm::dmat4& to_world, const SourceFile& file) {
  auto curves = read_curves(file, form);
  if (!curves) return curves;
  for (Curve& curve : curves->curves)
    for (ControlPoint& point : curve) {
      point.position = transform_point(to_world, point.position);
      if (!is_traceable(point))
        return fail(fmt::format("{}: a point is too far away, or its radius too large, for single precision",
                                file.path.string()));
    }
  return curves;
}

/// Curves of triangles, for what only those can do.
Expected<TessellatedShape> tubes(const PluginReader& plugin, const Expected<Curves>& curves,
                                 const SourceFile& file) {
  if (!curves) return std::unexpected(curves.error());
  auto made = curve_mesh(*curves);
  if (!made) return fail(fmt::format("{}: {}", file.path.string(), made.error().message));
  if (made->sides < 32)
    plugin.warn(fmt::format("so many curves have {} sides, within {:.1f} % of their radius", made->sides,
                            100 * made->error));
  return TessellatedShape{std::move(made->mesh)};
}

}  // namespace

Expected<Curves> curves_of(const BsplineCurveShape& shape, const SourceFile& file) {
  return curves(shape.form, shape.to_world, file);
}

Expected<Curves> curves_of(const LinearCurveShape& shape, const SourceFile& file) {
  return curves(CurveForm::kBalls, shape.to_world, file);
}

Expected<TessellatedShape> tessellated(const PluginReader& plugin, const BsplineCurveShape& shape,
                                       const SourceFile& file) {
  return tubes(plugin, curves_of(shape, file), file);
}

Expected<TessellatedShape> tessellated(const PluginReader& plugin, const LinearCurveShape& shape,
                                       const SourceFile& file) {
  return tubes(plugin, curves_of(shape, file), file);
}

Expected<TessellatedShape> tessellated(const PluginReader&, const SdfGridShape& shape,
                                       const SourceFile& file) {
  const auto grid = read_sdf_grid(file);
  if (!grid) return std::unexpected(grid.error());
  return TessellatedShape{sdf_mesh(*grid), shape.to_world};
}

}  // namespace penumbra::mitsuba
