// The families of BSDFs, and what a surface hands them: a resolved closure. A family is one file beside this
// one.
#ifndef PENUMBRA_FAMILIES_H
#define PENUMBRA_FAMILIES_H
#include "kernels/math/lane_record.h"

PENUMBRA_NAMESPACE_BEGIN

// Properties of a family.
#define CLOSED_FORM 1    // its light by polygon lights has a closed form: see light_unshadowed.h
#define SEVERAL_LOBES 2  // it chooses among lobes by a random number of its own
#define TRANSMITS 4      // it scatters to the other side
#define DELTA 8          // all its lobes are mirrors: direction samples alone find its light
#define SOME_DELTA 16    // some of its lobes are, others are not

// X(name, NAME, its number, properties, what it is for people): `name`_eval and `name`_sample in
// kernels/bsdf/`name`.h, and FAMILY_`NAME` below. Family 0 absorbs everything.
#ifdef EXTRA_BSDF_FAMILY_LIST  // of tests: see tests/support/stand_in_families
  #include EXTRA_BSDF_FAMILY_LIST
#else
  #define EXTRA_BSDF_FAMILIES(X)
#endif
#define BSDF_FAMILIES(X)                                        \
  X(diffuse, DIFFUSE, 1, CLOSED_FORM, "diffuse BSDF")           \
  X(phong, PHONG, 2, CLOSED_FORM | SEVERAL_LOBES, "Phong BSDF") \
  EXTRA_BSDF_FAMILIES(X)

// X(name, NAME): the families with two mirror lobes. `name`_lobe_probability(closure, wo) is that of the
// first: `name`_sample takes it where its choice is less.
#ifndef EXTRA_BRANCHING_FAMILIES
  #define EXTRA_BRANCHING_FAMILIES(X)
#endif
#define BRANCHING_FAMILIES(X) EXTRA_BRANCHING_FAMILIES(X)

// Plain macros as well, since the preprocessor has to test them.
#define FAMILY_BLACK 0
#define FAMILY_DIFFUSE 1
#define FAMILY_PHONG 2

// What a material has at a point. The record of a material holds the same.
#define CLOSURE_FIELDS(F, a)                                \
  F(a, int, family)     /* FAMILY_* */                      \
  F(a, vec3, diffuse)   /* diffuse reflectance */           \
  F(a, vec3, specular)  /* reflectance of the other lobe */ \
  F(a, float, exponent) /* Phong exponent n >= 0 */         \
  F(a, float, lobe)     /* probability of sampling the Phong lobe */
LANE_RECORD(Closure, Closures, closure, CLOSURE_FIELDS)

// The families that use each: what none in a scene uses is not read, and stays as in black_closure. Those of
// tests may use all.
#define FAMILY_BIT(name, NAME, number, properties, text) | (1u << (number))
#define EXTRA_FAMILIES (0u EXTRA_BSDF_FAMILIES(FAMILY_BIT))
#define USERS_family 0xffffffffu
#define USERS_diffuse ((1u << FAMILY_DIFFUSE) | (1u << FAMILY_PHONG) | EXTRA_FAMILIES)
#define USERS_specular ((1u << FAMILY_PHONG) | EXTRA_FAMILIES)
#define USERS_exponent ((1u << FAMILY_PHONG) | EXTRA_FAMILIES)
#define USERS_lobe ((1u << FAMILY_PHONG) | EXTRA_FAMILIES)

FN Closure black_closure(void) {
  Closure c;
  c.family = FAMILY_BLACK;
  c.diffuse = c.specular = make_vec3(0.0f, 0.0f, 0.0f);
  c.exponent = c.lobe = 0.0f;
  return c;
}

// Bit masks of families. A kernel is compiled for those of FAMILIES, which comes from the build.
#define EVERY_FAMILY (0u BSDF_FAMILIES(FAMILY_BIT))
#ifndef FAMILIES
  #define FAMILIES EVERY_FAMILY
#endif
#define HAS_FAMILY(name) (((FAMILIES) & (1u << FAMILY_##name)) != 0u)

FN uint compiled_families(void) { return FAMILIES; }

#define FAMILY_WITH(name, NAME, number, properties, text) | (((properties)&wanted) != 0 ? 1u << (number) : 0u)
/// Those with any of the wanted properties.
FN uint families_with(int wanted) { return 0u BSDF_FAMILIES(FAMILY_WITH); }
#undef FAMILY_WITH

#define BRANCHING_FAMILY(name, NAME) | (1u << FAMILY_##NAME)
FN uint branching_families(void) { return (0u BRANCHING_FAMILIES(BRANCHING_FAMILY)) & compiled_families(); }
#undef BRANCHING_FAMILY

/// Whether the closure is of one of the families.
FN bool is_among(Closure c, uint families) { return ((families >> c.family) & 1u) != 0u; }

FN bool has_closed_form(Closure c) { return is_among(c, families_with(CLOSED_FORM)); }

/// What it reflects altogether, as far as its colours say.
FN vec3 closure_albedo(Closure c) { return add(c.diffuse, c.specular); }

// --- What a family's functions return. Directions are in the frame of the shading normal, whose z is on the
// viewer's side; f is in 1/sr, pdfs per solid angle.

#define BSDF_VALUE_FIELDS(F, a)                             \
  F(a, vec3, f_cos) /* f times the absolute cosine of wi */ \
  F(a, float, pdf)  /* with which the family samples wi */
LANE_RECORD(BsdfValue, BsdfValues, bsdf_value, BSDF_VALUE_FIELDS)

#define BSDF_SAMPLE_FIELDS(F, a)                                                                    \
  F(a, vec3, wi)                                                                                    \
  F(a, vec3, weight) /* f cos / pdf */                                                              \
  F(a, float, pdf)   /* 0: no direction; DELTA_PDF: one of finitely many, which eval never finds */ \
  F(a, float, eta)   /* refractive index where wi leads over that where wo does; 1 if reflected */
LANE_RECORD(BsdfSample, BsdfSamples, bsdf_sample, BSDF_SAMPLE_FIELDS)

#define DELTA_PDF BITS_FLOAT(0x7f800000u)

FN BsdfValue no_bsdf_value(void) {
  BsdfValue value;
  value.f_cos = make_vec3(0.0f, 0.0f, 0.0f);
  value.pdf = 0.0f;
  return value;
}

FN BsdfSample no_bsdf_sample(void) {
  BsdfSample s;
  s.wi = make_vec3(0.0f, 0.0f, 1.0f);
  s.weight = make_vec3(0.0f, 0.0f, 0.0f);
  s.pdf = 0.0f;
  s.eta = 1.0f;
  return s;
}

PENUMBRA_NAMESPACE_END
#endif
