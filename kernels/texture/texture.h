// Simple textures, and the evaluation of textures at LANES surfaces: a lane loop for each kind among them,
// until no lane has a further texture.
#ifndef PENUMBRA_TEXTURE_H
#define PENUMBRA_TEXTURE_H
#include "kernels/intersect/surface_fields.h"
#include "kernels/intersect/surface_uv.h"
#include "kernels/motion/moving_surface.h"
#include "kernels/texture/bitmap_texture.h"
#include "kernels/texture/noise_texture.h"
#include "kernels/texture/texture_step.h"

PENUMBRA_NAMESPACE_BEGIN

/// Another texture, times a colour: `scale` of Mitsuba 0.6.
FN TextureStep scale_texture(const PRIVATE Scene* scene, GLOBAL const TextureNode* texture, TexturePlace at) {
  TextureStep step;
  step.factor = load3(&texture->colour0);
  step.next = texture->texture0;
  return step;
}

/// A checkerboard with 2 x 2 squares in each unit square of texture coordinates: colour0 where the fractional
/// parts of u and v are both above 1/2 or both at most 1/2, as in Mitsuba 3.
FN TextureStep checkerboard_texture(const PRIVATE Scene* scene, GLOBAL const TextureNode* texture,
                                    TexturePlace at) {
  const float u = at.u - floor_f(at.u), v = at.v - floor_f(at.v);
  const bool first = (u > 0.5f) == (v > 0.5f);
  const vec3 colour0 = load3(&texture->colour0), colour1 = load3(&texture->colour1);
  const int texture0 = texture->texture0, texture1 = texture->texture1;
  TextureStep step;
  step.factor = select3(first, colour0, colour1);
  step.next = first ? texture0 : texture1;
  return step;
}

/// Colours of a mesh's vertices or faces; black if the surface has no such colours.
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

#define TEXTURE_LANE_FIELDS(F, a)                       \
  F(a, vec3, value) /* product of the factors so far */ \
  F(a, int, next)   /* index of the next texture to multiply by, or -1 */
LANE_RECORD(TextureLane, TextureLanes, texture_lane, TEXTURE_LANE_FIELDS)

#define STEP_TEXTURES(name, NAME, number, description)                                                     \
  STAGE void step_##name##_textures(const PRIVATE Scene* scene, const PRIVATE Surfaces* RESTRICT surfaces, \
                                    PRIVATE TextureLanes* RESTRICT lanes) {                                \
    LANE_LOOP                                                                                              \
      for (int j = 0; j < LANES; j++) {                                                                    \
        const TextureLane lane = load_texture_lane(lanes, j);                                              \
        GLOBAL const TextureNode* texture = scene->textures + (lane.next >= 0 ? lane.next : 0);            \
        const bool here = (lane.next >= 0) & (texture->kind == (number));                                  \
        const TextureStep step =                                                                           \
            name##_texture(scene, texture, texture_place(texture, load_surface(surfaces, j)));             \
        TextureLane after;                                                                                 \
        after.value = mul(lane.value, step.factor);                                                        \
        after.next = step.next;                                                                            \
        store_texture_lane(lanes, j, select_texture_lane(here, after, lane));                              \
      }                                                                                                    \
  }
TEXTURE_KINDS(STEP_TEXTURES)
#undef STEP_TEXTURES

/// A mask of the kinds of the lanes' next textures.
FN uint texture_kinds_among(const PRIVATE Scene* scene, const PRIVATE TextureLanes* lanes) {
  uint among = 0u;
  for (int j = 0; j < LANES; j++)
    among |= lanes->next[j] >= 0 ? 1u << scene->textures[lanes->next[j]].kind : 0u;
  return among;
}

/// Moves the points of instances, and of what moves, to where the triangles' records are.
FN void rest_positions(const PRIVATE Scene* scene, const PRIVATE Surfaces* surfaces, PRIVATE Surfaces* rest) {
  *rest = *surfaces;
  for (int j = 0; j < LANES; j++) {
    const Surface s = load_surface(surfaces, j);
    if (NEEDS(scene, INSTANCES) && s.instance >= 0)
      STORE_LANE_vec3(rest->p, j, to_group_point(instance_of(scene, s.instance, s.time), s.p));
    else if (has_moving_surfaces(scene) && is_moving_triangle(scene, s.primitive, -1))
      STORE_LANE_vec3(rest->p, j, rest_position(scene, s));
  }
}

/// The values of the textures (indices, or -1) at the surfaces; 1 for -1. Textures only refer to textures
/// with lower indices, so the loop ends.
CALLED_FN void eval_textures(const PRIVATE Scene* scene, const PRIVATE Surfaces* surfaces,
                             const PRIVATE int* textures, PRIVATE TextureLanes* lanes) {
  for (int j = 0; j < LANES; j++) {
    TextureLane lane;
    lane.value = make_vec3(1.0f, 1.0f, 1.0f);
    lane.next = textures[j];
    store_texture_lane(lanes, j, lane);
  }
  for (uint among = texture_kinds_among(scene, lanes); among != 0u;
       among = texture_kinds_among(scene, lanes)) {
    const PRIVATE Surfaces* at = surfaces;
    Surfaces rest;
    if ((among >> TEXTURE_MESH_ATTRIBUTE & 1u) != 0u &&
        (NEEDS(scene, INSTANCES) || has_moving_surfaces(scene))) {
      rest_positions(scene, surfaces, &rest);
      at = &rest;
    }
#define STEP_KIND(name, NAME, number, description)                                 \
  if (((TEXTURE_KINDS_MASK) >> (number)&1u) != 0u && (among >> (number)&1u) != 0u) \
    step_##name##_textures(scene, (number) == TEXTURE_MESH_ATTRIBUTE ? at : surfaces, lanes);
    TEXTURE_KINDS(STEP_KIND)
#undef STEP_KIND
  }
}

PENUMBRA_NAMESPACE_END
#endif
