// Colours of a mesh's vertices or faces.
#ifndef PENUMBRA_MESH_ATTRIBUTE_TEXTURE_H
#define PENUMBRA_MESH_ATTRIBUTE_TEXTURE_H
#include "kernels/intersect/surface_uv.h"
#include "kernels/texture/texture_step.h"

PENUMBRA_NAMESPACE_BEGIN

/// Black if the surface has no such colours.
FN TextureStep mesh_attribute_texture(const PRIVATE Scene* scene, GLOBAL const TextureNode* texture,
                                      TexturePlace at) {
  const bool on_triangle = (at.primitive >= 0) & (at.primitive < scene->header.tables.triangle_colours.count);
  const int triangle = on_triangle ? at.primitive : 0;
  const int first = scene->triangle_colours[triangle];
  const bool some = on_triangle & (first >= 0);
  GLOBAL const VertexColours* colours = scene->vertex_colours + (some ? first + texture->attribute : 0);
  const Barycentric b = barycentric_of(scene->triangles + triangle, at.p);
  // By rounding, the point may be slightly outside of the triangle.
  const float b1 = clamp_f(b.b1, 0.0f, 1.0f), b2 = clamp_f(b.b2, 0.0f, 1.0f - b1);
  const vec3 c0 = load3(&colours->c0);
  const vec3 value =
      add_scaled(add_scaled(c0, b1, sub(load3(&colours->c1), c0)), b2, sub(load3(&colours->c2), c0));
  TextureStep step;
  step.factor = select3(some, mul(load3(&texture->colour0), value), make_vec3(0.0f, 0.0f, 0.0f));
  step.next = texture->texture0;
  return step;
}

PENUMBRA_NAMESPACE_END
#endif
