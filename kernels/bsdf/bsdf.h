// Resolves materials to closures, and calls the functions of the closures' families: LANES at a time, one
// lane loop for each family among them. The families of a scene are known, so others cost nothing.
#ifndef PENUMBRA_BSDF_H
#define PENUMBRA_BSDF_H
#include "kernels/bsdf/conductor.h"
#include "kernels/bsdf/dielectric.h"
#include "kernels/bsdf/diffuse.h"
#include "kernels/bsdf/disney.h"
#include "kernels/bsdf/hair.h"
#include "kernels/bsdf/measured.h"
#include "kernels/bsdf/microfacet_diffuse.h"
#include "kernels/bsdf/openpbr.h"
#include "kernels/bsdf/phase.h"
#include "kernels/bsdf/phong.h"
#include "kernels/bsdf/plastic.h"
#include "kernels/bsdf/principled.h"
#include "kernels/bsdf/principledthin.h"
#include "kernels/bsdf/roughplastic.h"
#include "kernels/bsdf/ward.h"
#ifdef EXTRA_BSDF_FAMILY_LIST
  #include EXTRA_BSDF_FAMILY_FUNCTIONS
#endif
#include "kernels/intersect/surface_fields.h"
#include "kernels/math/frame.h"
#include "kernels/scene.h"
#include "kernels/texture/texture.h"

PENUMBRA_NAMESPACE_BEGIN

#define MATERIAL_VALUE_int(field) field
#define MATERIAL_VALUE_float(field) field
#define MATERIAL_VALUE_vec3(field) load3(&field)

// Copies a field of LANES materials to closures.
#define RESOLVE_LANES(a, type, name)                                                                   \
  STAGE void resolve_##name##_lanes(const PRIVATE Scene* scene, const PRIVATE int* RESTRICT materials, \
                                    PRIVATE Closures* RESTRICT closures) {                             \
    LANE_LOOP                                                                                          \
      for (int j = 0; j < LANES; j++) {                                                                \
        GLOBAL const Material* material = scene->materials + materials[j];                             \
        STORE_ENTRY_##type(closures->name, LANES, j, MATERIAL_VALUE_##type(material->name));           \
      }                                                                                                \
  }                                                                                                    \
  STAGE void clear_##name##_lanes(PRIVATE Closures* RESTRICT closures) {                               \
    LANE_LOOP                                                                                          \
      for (int j = 0; j < LANES; j++) STORE_ENTRY_##type(closures->name, LANES, j, ZERO_##type);       \
  }
CLOSURE_FIELDS(RESOLVE_LANES, )
#undef RESOLVE_LANES

#define LANE_OF_float(value) luminance(value)
#define LANE_OF_vec3(value) (value)
// Evaluates a field's texture, for materials that have one.
#define TEXTURE_LANES(a, type, name)                                                                   \
  STAGE bool note_##name##_textures(const PRIVATE Scene* scene, const PRIVATE int* RESTRICT materials, \
                                    PRIVATE int* RESTRICT textures) {                                  \
    int any = 0;                                                                                       \
    for (int j = 0; j < LANES; j++) {                                                                  \
      textures[j] = scene->materials[materials[j]].name##_texture;                                     \
      any |= textures[j] >= 0 ? 1 : 0;                                                                 \
    }                                                                                                  \
    return any != 0;                                                                                   \
  }                                                                                                    \
  STAGE void store_##name##_textures(const PRIVATE int* RESTRICT textures,                             \
                                     const PRIVATE TextureLanes* RESTRICT found,                       \
                                     PRIVATE Closures* RESTRICT closures) {                            \
    LANE_LOOP                                                                                          \
      for (int j = 0; j < LANES; j++) {                                                                \
        const type before = LOAD_ENTRY_##type(closures->name, LANES, j);                               \
        const type value = LANE_OF_##type(LOAD_LANE_vec3(found->value, j));                            \
        STORE_ENTRY_##type(closures->name, LANES, j, SELECT_##type(textures[j] >= 0, value, before));  \
      }                                                                                                \
  }                                                                                                    \
  FN void texture_##name##_lanes(const PRIVATE Scene* scene, const PRIVATE Surfaces* surfaces,         \
                                 PRIVATE Closures* closures) {                                         \
    int textures[LANES];                                                                               \
    TextureLanes found;                                                                                \
    if (!note_##name##_textures(scene, surfaces->material, textures)) return;                          \
    eval_textures(scene, surfaces, textures, &found);                                                  \
    store_##name##_textures(textures, &found, closures);                                               \
  }
TEXTURED_FIELDS(TEXTURE_LANES, )
#undef TEXTURE_LANES

/// A mask of the families of LANES closures.
FN ulong families_among(const PRIVATE Closures* closures) {
  ulong families = 0u;
  for (int j = 0; j < LANES; j++) families |= (ulong)1 << closures->family[j];
  return families & compiled_families();
}

/// Sets where across their fibres hair is seen: v runs from one edge to the other.
STAGE void offset_hair_lanes(const PRIVATE float* RESTRICT v, PRIVATE float* RESTRICT offsets) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++) offsets[j] = clamp_f(2.0f * v[j] - 1.0f, -1.0f, 1.0f);
}

/// The x axis of the frame in which a family with these `properties` (a constant) is evaluated; 0 if any axis
/// will do. The frame of an isotropic closure does not follow the tangent, so that images do not depend on
/// whether the tangent is known.
FN vec3 family_axis(int properties, Closure c, Surface s) {
  const vec3 none = make_vec3(0.0f, 0.0f, 0.0f);
  const vec3 tangent = select3(is_anisotropic(c), s.tangent, none);
  return (properties & ANISOTROPIC) != 0 ? tangent_axis(s.shading, tangent) : none;
}
FN vec3 to_family_frame(int properties, vec3 n, vec3 axis, vec3 v) {
  if ((properties & FREE) != 0) return v;
  if ((properties & ANISOTROPIC) == 0) return to_frame(n, v);
  return make_vec3(dot3(axis, v), dot3(cross3(n, axis), v), dot3(n, v));
}
FN vec3 from_family_frame(int properties, vec3 n, vec3 axis, vec3 v) {
  if ((properties & FREE) != 0) return v;
  if ((properties & ANISOTROPIC) == 0) return from_frame(n, v.x, v.y, v.z);
  return add_scaled(add_scaled(scale(axis, v.x), v.y, cross3(n, axis)), v.z, n);
}

/// Sets the normals of coats that have their own.
STAGE void tilt_coat_lanes(const PRIVATE Surfaces* RESTRICT surfaces, PRIVATE Closures* RESTRICT closures) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      const Closure c = load_closure(closures, j);
      const Surface s = load_surface(surfaces, j);
      const vec3 there = to_family_frame(ANISOTROPIC, s.shading, family_axis(ANISOTROPIC, c, s), s.coat);
      // The base's own stays itself, without rounding.
      const bool same = max_component(abs3(sub(s.coat, s.shading))) == 0.0f;
      STORE_LANE_vec3(closures->coat_normal, j, select3(same, make_vec3(0.0f, 0.0f, 1.0f), there));
    }
}

/// Resolves the closures of the surfaces' materials. Fields that none of their families uses become 0; those
/// that no material of the scene uses are unchanged.
FN void resolve_closures(const PRIVATE Scene* scene, const PRIVATE Surfaces* surfaces,
                         PRIVATE Closures* closures) {
  const ulong of_scene = NEEDED(FAMILIES, scene->header.families) & compiled_families();
  resolve_family_lanes(scene, surfaces->material, closures);
  const ulong families = families_among(closures);
#define RESOLVE_IF_USED(a, type, name)                                               \
  if ((COMPILED_FAMILIES & USERS_##name) != 0u && (of_scene & USERS_##name) != 0u) { \
    if ((families & USERS_##name) != 0u)                                             \
      resolve_##name##_lanes(scene, surfaces->material, closures);                   \
    else                                                                             \
      clear_##name##_lanes(closures);                                                \
  }
  CLOSURE_PARAMETERS(RESOLVE_IF_USED, )
#undef RESOLVE_IF_USED
#define TEXTURE_IF_USED(a, type, name)                                               \
  if ((COMPILED_FAMILIES & USERS_##name) != 0u && (families & USERS_##name) != 0u && \
      (scene->header.textured >> TEXTURED_##name & 1u) != 0u)                        \
    texture_##name##_lanes(scene, surfaces, closures);
  if (NEEDS(scene, TEXTURES)) {
    TEXTURED_FIELDS(TEXTURE_IF_USED, )
  }
#undef TEXTURE_IF_USED
  if (HAS_FAMILY(HAIR) && (families & ONLY(HAIR)) != 0u) offset_hair_lanes(surfaces->v, closures->offset);
  if (NEEDS(scene, COAT_NORMALS) && (families & OPENPBRS_LAYERED) != 0u) tilt_coat_lanes(surfaces, closures);
}

#define EVAL_FAMILY(LOOP, name, number, properties)                                                     \
  STAGE void eval_##name##_lanes(const PRIVATE Scene* scene, const PRIVATE Closures* RESTRICT closures, \
                                 const PRIVATE Surfaces* RESTRICT surfaces,                             \
                                 const PRIVATE float* RESTRICT wi, bool first,                          \
                                 PRIVATE BsdfValues* RESTRICT values) {                                 \
    LOOP for (int j = 0; j < LANES; j++) {                                                              \
      const Closure c = load_closure(closures, j);                                                      \
      const Surface s = load_surface(surfaces, j);                                                      \
      const vec3 direction = LOAD_LANE_vec3(wi, j);                                                     \
      const vec3 axis = family_axis(properties, c, s);                                                  \
      const BsdfValue value = name##_eval(scene, c, to_family_frame(properties, s.shading, axis, s.wo), \
                                          to_family_frame(properties, s.shading, axis, direction));     \
      const BsdfValue before = select_bsdf_value(first, no_bsdf_value(), load_bsdf_value(values, j));   \
      store_bsdf_value(values, j, select_bsdf_value(c.family == (number), value, before));              \
    }                                                                                                   \
  }
#define SAMPLE_FAMILY(LOOP, name, number, properties)                                                      \
  STAGE void sample_##name##_lanes(const PRIVATE Scene* scene, const PRIVATE Closures* RESTRICT closures,  \
                                   const PRIVATE Surfaces* RESTRICT surfaces,                              \
                                   const PRIVATE float* RESTRICT uv, const PRIVATE float* RESTRICT choice, \
                                   bool first, PRIVATE BsdfSamples* RESTRICT samples) {                    \
    LOOP for (int j = 0; j < LANES; j++) {                                                                 \
      const Closure c = load_closure(closures, j);                                                         \
      const Surface s = load_surface(surfaces, j);                                                         \
      const vec3 axis = family_axis(properties, c, s);                                                     \
      const vec3 wo = to_family_frame(properties, s.shading, axis, s.wo);                                  \
      BsdfSample next = name##_sample(scene, c, wo, uv[j], uv[LANES + j], choice[j]);                      \
      next.wi = from_family_frame(properties, s.shading, axis, next.wi);                                   \
      const BsdfSample before = select_bsdf_sample(first, no_bsdf_sample(), load_bsdf_sample(samples, j)); \
      store_bsdf_sample(samples, j, select_bsdf_sample(c.family == (number), next, before));               \
    }                                                                                                      \
  }
#define IN_LANES(name, NAME, number, properties, text) \
  EVAL_FAMILY(LANE_LOOP, name, number, properties)     \
  SAMPLE_FAMILY(LANE_LOOP, name, number, properties)
#define BY_CALLS(name, NAME, number, properties, text) \
  EVAL_FAMILY(PLAIN_LOOP, name, number, properties)    \
  SAMPLE_FAMILY(PLAIN_LOOP, name, number, properties)
LANE_BSDF_FAMILIES(IN_LANES)
EXTRA_BSDF_FAMILIES(IN_LANES)
CALLED_BSDF_FAMILIES(BY_CALLS)
#undef EVAL_FAMILY
#undef SAMPLE_FAMILY
#undef IN_LANES
#undef BY_CALLS

STAGE void clear_bsdf_values(PRIVATE BsdfValues* RESTRICT values) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++) store_bsdf_value(values, j, no_bsdf_value());
}
STAGE void clear_bsdf_samples(PRIVATE BsdfSamples* RESTRICT samples) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++) store_bsdf_sample(samples, j, no_bsdf_sample());
}

/// Evaluates closures of these `families` for the unit directions `wi`, a lane vec3.
CALLED_FN void eval_bsdfs(const PRIVATE Scene* scene, ulong families, const PRIVATE Closures* closures,
                          const PRIVATE Surfaces* surfaces, const PRIVATE float* wi,
                          PRIVATE BsdfValues* values) {
  bool first = true;
#define EVAL_IF_THERE(name, NAME, number, properties, text)                             \
  if (HAS_FAMILY(NAME) && ((properties)&DELTA) == 0 && (families & ONLY(NAME)) != 0u) { \
    eval_##name##_lanes(scene, closures, surfaces, wi, first, values);                  \
    first = false;                                                                      \
  }
  BSDF_FAMILIES(EVAL_IF_THERE)
#undef EVAL_IF_THERE
  if (first) clear_bsdf_values(values);
}

/// Samples directions by the closures, in world space. `uv` has LANES numbers u, then LANES numbers v.
CALLED_FN void sample_bsdfs(const PRIVATE Scene* scene, ulong families, const PRIVATE Closures* closures,
                            const PRIVATE Surfaces* surfaces, const PRIVATE float* uv,
                            const PRIVATE float* choice, PRIVATE BsdfSamples* samples) {
  bool first = true;
#define SAMPLE_IF_THERE(name, NAME, number, properties, text)                     \
  if (HAS_FAMILY(NAME) && (families & ONLY(NAME)) != 0u) {                        \
    sample_##name##_lanes(scene, closures, surfaces, uv, choice, first, samples); \
    first = false;                                                                \
  }
  BSDF_FAMILIES(SAMPLE_IF_THERE)
#undef SAMPLE_IF_THERE
  if (first) clear_bsdf_samples(samples);
}

#define LOBE_PROBABILITY(name, NAME)                                             \
  STAGE void name##_probability_lanes(const PRIVATE Closures* RESTRICT closures, \
                                      const PRIVATE Surfaces* RESTRICT surfaces, \
                                      PRIVATE float* RESTRICT probabilities) {   \
    LANE_LOOP                                                                    \
      for (int j = 0; j < LANES; j++) {                                          \
        const Closure c = load_closure(closures, j);                             \
        const Surface s = load_surface(surfaces, j);                             \
        const float p = name##_lobe_probability(c, to_frame(s.shading, s.wo));   \
        probabilities[j] = c.family == FAMILY_##NAME ? p : probabilities[j];     \
      }                                                                          \
  }
BRANCHING_FAMILIES(LOBE_PROBABILITY)
#undef LOBE_PROBABILITY

/// The probabilities of the first lobes of closures of BRANCHING_FAMILIES; 1 for others.
FN void lobe_probabilities(ulong families, const PRIVATE Closures* closures, const PRIVATE Surfaces* surfaces,
                           PRIVATE float* probabilities) {
  for (int j = 0; j < LANES; j++) probabilities[j] = 1.0f;
#define PROBABILITY_IF_THERE(name, NAME)                 \
  if (HAS_FAMILY(NAME) && (families & ONLY(NAME)) != 0u) \
    name##_probability_lanes(closures, surfaces, probabilities);
  BRANCHING_FAMILIES(PROBABILITY_IF_THERE)
#undef PROBABILITY_IF_THERE
}

/// Evaluates a single closure for a pair of world-space directions, with the surface's normal n and any
/// tangent.
CALLED_FN BsdfValue eval_bsdf(const PRIVATE Scene* scene, Closure c, vec3 n, vec3 wo, vec3 wi) {
  const vec3 axis = tangent_axis(n, make_vec3(0.0f, 0.0f, 0.0f));
  switch (c.family) {
#define EVAL_ONE(name, NAME, number, properties, text)                     \
  case number:                                                             \
    return name##_eval(scene, c, to_family_frame(properties, n, axis, wo), \
                       to_family_frame(properties, n, axis, wi));
    BSDF_FAMILIES(EVAL_ONE)
#undef EVAL_ONE
    default:
      return no_bsdf_value();
  }
}

/// Samples a single closure likewise.
CALLED_FN BsdfSample sample_bsdf(const PRIVATE Scene* scene, Closure c, vec3 n, vec3 wo, float u, float v,
                                 float choice) {
  const vec3 axis = tangent_axis(n, make_vec3(0.0f, 0.0f, 0.0f));
  BsdfSample s = no_bsdf_sample();
  switch (c.family) {
#define SAMPLE_ONE(name, NAME, number, properties, text)                                 \
  case number:                                                                           \
    s = name##_sample(scene, c, to_family_frame(properties, n, axis, wo), u, v, choice); \
    s.wi = from_family_frame(properties, n, axis, s.wi);                                 \
    break;
    BSDF_FAMILIES(SAMPLE_ONE)
#undef SAMPLE_ONE
    default:
      break;
  }
  return s;
}

PENUMBRA_NAMESPACE_END
#endif
