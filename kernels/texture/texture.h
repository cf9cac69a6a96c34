// Evaluates textures at LANES surfaces: a lane loop for each kind among them, until no lane has a further
// texture.
#ifndef PENUMBRA_TEXTURE_H
#define PENUMBRA_TEXTURE_H
#include "kernels/intersect/surface_fields.h"
#include "kernels/texture/bitmap_texture.h"
#include "kernels/texture/checkerboard_texture.h"
#include "kernels/texture/mesh_attribute_texture.h"
#include "kernels/texture/noise_texture.h"
#include "kernels/texture/scale_texture.h"

PENUMBRA_NAMESPACE_BEGIN

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
#define STEP_KIND(name, NAME, number, description)                                 \
  if (((TEXTURE_KINDS_MASK) >> (number)&1u) != 0u && (among >> (number)&1u) != 0u) \
    step_##name##_textures(scene, surfaces, lanes);
    TEXTURE_KINDS(STEP_KIND)
#undef STEP_KIND
  }
}

PENUMBRA_NAMESPACE_END
#endif
