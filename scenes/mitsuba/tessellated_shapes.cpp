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
Expected<TessellatedShape> curves(const PluginReader& plugin, const glm::dmat4& to_world,
                                  const SourceFile& file, std::size_t least,
                                  Expected<CurveMesh> (*make)(std::span<const Curve>)) {
  auto curves = read_curves(file, least);
  if (!curves) return std::unexpected(curves.error());
  for (Curve& curve : *curves)
    for (ControlPoint& point : curve) {
      point.position = transform_point(to_world, point.position);
      const glm::dvec3 far = glm::abs(point.position);
      if (!(far.x + far.y + far.z + point.radius < kFarthest))
        return fail(fmt::format("{}: a point is too far away, or its radius too large, for single precision",
                                file.path.string()));
    }
  auto made = make(*curves);
  if (!made) return fail(fmt::format("{}: {}", file.path.string(), made.error().message));
  if (made->sides < 32)
    plugin.warn(fmt::format("so many curves have {} sides, within {:.1f} % of their radius", made->sides,
                            100 * made->error));
  return TessellatedShape{std::move(made->mesh)};
}

}  // namespace

Expected<TessellatedShape> tessellated(const PluginReader& plugin, const BsplineCurveShape& shape,
                                       const SourceFile& file) {
  return curves(plugin, shape.to_world, file, 4, bspline_curve_mesh);
}

Expected<TessellatedShape> tessellated(const PluginReader& plugin, const LinearCurveShape& shape,
                                       const SourceFile& file) {
  return curves(plugin, shape.to_world, file, 2, linear_curve_mesh);
}

Expected<TessellatedShape> tessellated(const PluginReader&, const SdfGridShape& shape,
                                       const SourceFile& file) {
  const auto grid = read_sdf_grid(file);
  if (!grid) return std::unexpected(grid.error());
  return TessellatedShape{sdf_mesh(*grid), shape.to_world};
}

}  // namespace penumbra::mitsuba
