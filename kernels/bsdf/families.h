// The families of BSDFs, and the resolved closure that a surface passes to them. Each family has a file in
// this folder.
#ifndef PENUMBRA_FAMILIES_H
#define PENUMBRA_FAMILIES_H
#include "kernels/math/lane_record.h"

PENUMBRA_NAMESPACE_BEGIN

// Properties of a family.
#define CLOSED_FORM 1    // closed form under polygon lights: see light_unshadowed.h
#define SEVERAL_LOBES 2  // chooses among lobes by a random number of its own
#define TRANSMITS 4      // scatters to the other side
#define ANISOTROPIC 8    // the x axis of its frame is the direction of increasing u, see tangent_axis
#define DELTA 16         // all its directions have DELTA_PDF; eval returns 0
#define SOME_DELTA 32    // some of its directions have DELTA_PDF
#define FREE 64          // no surface: its frame is the scene's, and its values include no cosine

// X(name, NAME, number, properties, description for users): kernels/bsdf/`name`.h defines `name`_eval and
// `name`_sample.
#define LANE_BSDF_FAMILIES(X)                                                                            \
  X(diffuse, DIFFUSE, 1, CLOSED_FORM, "diffuse BSDF")                                                    \
  X(phong, PHONG, 2, CLOSED_FORM | SEVERAL_LOBES, "Phong BSDF")                                          \
  X(conductor, CONDUCTOR, 3, DELTA, "smooth conductor")                                                  \
  X(roughconductor_ggx, ROUGHCONDUCTOR_GGX, 4, ANISOTROPIC, "rough conductor, GGX")                      \
  X(roughconductor_beckmann, ROUGHCONDUCTOR_BECKMANN, 5, ANISOTROPIC, "rough conductor, Beckmann")       \
  X(dielectric, DIELECTRIC, 6, SEVERAL_LOBES | TRANSMITS | DELTA, "smooth dielectric")                   \
  X(thindielectric, THINDIELECTRIC, 7, SEVERAL_LOBES | TRANSMITS | DELTA, "thin dielectric")             \
  X(roughdielectric_ggx, ROUGHDIELECTRIC_GGX, 8, SEVERAL_LOBES | TRANSMITS | ANISOTROPIC,                \
    "rough dielectric, GGX")                                                                             \
  X(roughdielectric_beckmann, ROUGHDIELECTRIC_BECKMANN, 9, SEVERAL_LOBES | TRANSMITS | ANISOTROPIC,      \
    "rough dielectric, Beckmann")                                                                        \
  X(plastic, PLASTIC, 10, SEVERAL_LOBES | SOME_DELTA, "plastic")                                         \
  X(roughplastic_ggx, ROUGHPLASTIC_GGX, 11, SEVERAL_LOBES, "rough plastic, GGX")                         \
  X(roughplastic_beckmann, ROUGHPLASTIC_BECKMANN, 12, SEVERAL_LOBES, "rough plastic, Beckmann")          \
  X(ward, WARD, 13, SEVERAL_LOBES | ANISOTROPIC, "Ward BSDF")                                            \
  X(blinnphong, BLINNPHONG, 14, SEVERAL_LOBES, "Blinn-Phong BSDF")                                       \
  X(microfacet_diffuse, MICROFACET_DIFFUSE, 15, SEVERAL_LOBES, "microfacet BSDF with a diffuse part")    \
  X(principled, PRINCIPLED, 16, SEVERAL_LOBES | ANISOTROPIC, "principled BSDF")                          \
  X(principledthin, PRINCIPLEDTHIN, 17, SEVERAL_LOBES | TRANSMITS | ANISOTROPIC, "thin principled BSDF") \
  X(disney, DISNEY, 18, SEVERAL_LOBES | ANISOTROPIC, "Disney BRDF")                                      \
  X(principled_transmitting, PRINCIPLED_TRANSMITTING, 19, SEVERAL_LOBES | TRANSMITS | ANISOTROPIC,       \
    "principled BSDF that transmits")                                                                    \
  X(phase, PHASE, 20, SEVERAL_LOBES | TRANSMITS | FREE, "phase functions of media")                      \
  X(roughdiffuse, ROUGHDIFFUSE, 22, 0, "rough diffuse BSDF")                                             \
  X(difftrans, DIFFTRANS, 23, SEVERAL_LOBES | TRANSMITS, "diffuse reflection and transmission")          \
  X(openpbr, OPENPBR, 24, SEVERAL_LOBES, "OpenPBR's base")                                               \
  X(hair, HAIR, 25, SEVERAL_LOBES | TRANSMITS | ANISOTROPIC, "fibres of hair")                           \
  X(openpbr_layered, OPENPBR_LAYERED, 26, SEVERAL_LOBES | TRANSMITS | ANISOTROPIC, "OpenPBR's surface")  \
  X(openpbr_film, OPENPBR_FILM, 27, SEVERAL_LOBES | TRANSMITS | ANISOTROPIC, "... with a thin film")

// Those whose functions are called lane by lane: their code is too long to stand side by side for all lanes.
#define CALLED_BSDF_FAMILIES(X) X(measured, MEASURED, 32, ANISOTROPIC, "measured BRDF")

#define OWN_BSDF_FAMILIES(X) LANE_BSDF_FAMILIES(X) CALLED_BSDF_FAMILIES(X)

#ifdef EXTRA_BSDF_FAMILY_LIST  // for tests: see tests/support/extra_families
  #include EXTRA_BSDF_FAMILY_LIST
#else
  #define EXTRA_BSDF_FAMILIES(X)
#endif
#define BSDF_FAMILIES(X) OWN_BSDF_FAMILIES(X) EXTRA_BSDF_FAMILIES(X)

#define ENUMERATE_FAMILY(name, NAME, number, properties, text) FAMILY_##NAME = number,
/// FAMILY_BLACK absorbs everything. The tests' list defines the numbers of its own families.
enum { FAMILY_BLACK, OWN_BSDF_FAMILIES(ENUMERATE_FAMILY) };
#undef ENUMERATE_FAMILY

// X(name, NAME): the families with two delta lobes. `name`_lobe_probability(closure, wo) is the probability
// of the first lobe; `name`_sample takes it if `choice` is below that.
#define BRANCHING_FAMILIES(X) X(dielectric, DIELECTRIC) X(thindielectric, THINDIELECTRIC)

// The parameters of a material at a point. The record of a material has the same fields, and for each of
// TEXTURED_FIELDS a texture index or -1. If a field's meaning differs between families, the family's file
// explains it.
#define TEXTURED_FIELDS(F, a)                                                                \
  F(a, vec3, diffuse)     /* diffuse reflectance; base colour */                             \
  F(a, vec3, specular)    /* reflectance of the other (specular) lobe */                     \
  F(a, vec3, transmitted) /* transmittance of the other (specular) lobe */                   \
  F(a, vec3, eta)         /* conductor: refractive index relative to the outside */          \
  F(a, vec3, k)           /* conductor: absorption, likewise */                              \
  F(a, float, ior)        /* refractive index of the inside relative to the outside */       \
  F(a, float, alpha_u)    /* microfacet roughness along the tangent */                       \
  F(a, float, alpha_v)    /* ... and perpendicular to it */                                  \
  F(a, float, exponent)   /* Phong exponent n >= 0 */                                        \
  F(a, float, roughness)  /* of Disney's BSDFs, from here on in [0, 1] (see principled.h) */ \
  F(a, float, anisotropic)                                                                   \
  F(a, float, metallic)                                                                      \
  F(a, float, spec_trans)                                                                    \
  F(a, float, diff_trans) /* in [0, 2] */                                                    \
  F(a, float, spec_tint)                                                                     \
  F(a, float, specular_level)                                                                \
  F(a, float, sheen)                                                                         \
  F(a, float, sheen_tint)                                                                    \
  F(a, float, flatness) /* or subsurface */                                                  \
  F(a, float, clearcoat)                                                                     \
  F(a, float, clearcoat_gloss)                                                               \
  F(a, float, film)           /* OpenPBR: weight of its thin film */                         \
  F(a, float, film_thickness) /* ... place in the thicknesses of its table, in [0, 1] */     \
  F(a, vec3, subsurface)      /* OpenPBR: colour of what scatters below */
#define CLOSURE_PARAMETERS(F, a)                                                   \
  F(a, int, variant)         /* of the family's formula */                         \
  F(a, int, curve)           /* start of its values in the table of curves */      \
  F(a, int, curve_rows)      /* number of its curves */                            \
  F(a, int, film_rows)       /* number of thicknesses of its film; 0: no film */   \
  F(a, int, first_lobe)      /* phase functions: index in the table of lobes */    \
  F(a, float, internal)      /* diffuse reflectance of the boundary from inside */ \
  F(a, float, specular_rate) /* principled: relative sampling rates of lobes */    \
  F(a, float, diffuse_rate)                                                        \
  F(a, float, clearcoat_rate)                                                      \
  F(a, float, diff_trans_rate)                                                     \
  F(a, float, tilt)       /* hair: of its scales, in turns */                      \
  F(a, float, offset)     /* hair: across the fibre, in [-1, 1], see bsdf.h */     \
  F(a, vec3, coat_normal) /* OpenPBR: of its coat, in its frame, see bsdf.h */     \
  TEXTURED_FIELDS(F, a)
#define CLOSURE_FIELDS(F, a)       \
  F(a, int, family) /* FAMILY_* */ \
  CLOSURE_PARAMETERS(F, a)
LANE_RECORD(Closure, Closures, closure, CLOSURE_FIELDS)

#define ENUMERATE_TEXTURED(a, type, name) TEXTURED_##name,
/// Indices of the fields that may have textures.
enum { TEXTURED_FIELDS(ENUMERATE_TEXTURED, ) TEXTURED_FIELD_COUNT };
#undef ENUMERATE_TEXTURED

#define CURVE_KNOTS 64                  // values of a curve, at cosines from 0 to 1
#define CURVE_ROWS 32                   // curves of a material with textured roughness, see roughplastic.h
#define CURVE_STRIDE (CURVE_KNOTS + 1)  // offset from curve to curve
#define FIRST_FACET_PLACE 0.177827941f  // fourth root of the roughness of the first row, 0.001: see openpbr.h
#define LEAST_FUZZ_ROUGHNESS 0.1f

// Curves of thin films, see thin_film.h.
#define FILM_KNOTS 128
#define FILM_METALS 8
#define FILM_ROWS 32  // thicknesses at most
#define FILM_CURVE (3 * (FILM_KNOTS + 1))
#define FILM_REFLECTANCES ((1 + FILM_METALS) * FILM_CURVE)

// Tables of measured BRDFs, see measured.h.
#define MEASURED_HEADER 12  // numbers
#define MEASURED_NODES 128  // azimuths, or polar angles, of wo at most: 2^7, see measured.h
#define MEASURED_SIDE 512   // knots along one side of a grid at most: 2^9
// Symmetries. An anisotropic one has azimuths of the whole circle, or of [-pi, 0] or [-pi, -pi / 2].
#define MEASURED_ISOTROPIC 0
#define MEASURED_WHOLE 1
#define MEASURED_HALF 2
#define MEASURED_QUARTER 4

#define DISTRIBUTION_BECKMANN 0
#define DISTRIBUTION_GGX 1
#define PRINCIPLED_INSIDE 1  // variant: wo is inside

// Variants of OpenPBR's surface, as bits, and the sets of its curves. The base has the first one.
#define OPENPBR_INSIDE 1
#define OPENPBR_THIN 2
#define OPENPBR_BY_AZIMUTH 4    // rows of the base's curves differ by azimuth, else by roughness
#define OPENPBR_WEIGHT_TINTS 8  // the specular weight is a factor of the dielectric's reflection, too
#define OPENPBR_TINT_FADES 16   // towards white at grazing angles, as in glTF
#define OPENPBR_WALKS 32        // what scatters below goes into the medium inside, see interiors.h
#define OPENPBR_GLTF 64         // parameters have glTF's meaning, see openpbr.h
#define OPENPBR_OWN_COAT 128    // the coat has a normal of its own
#define OPENPBR_BASE 0
#define OPENPBR_PLAIN_SETS 1
#define OPENPBR_SCATTERED 1
#define OPENPBR_COAT 2
#define OPENPBR_FUZZ 3
#define OPENPBR_FUZZ_NARROW 4
#define OPENPBR_FUZZ_LEAN 5
#define OPENPBR_REFRACTED 5  // of glTF, whose fuzz does not lean: as if facets refracted all light
#define OPENPBR_SETS 6
#define OPENPBR_PACKED 32767  // the base has two albedos of so many steps in one number
#define OPENPBR_PACKED_BITS 15

// Variants of plastics: what each reflection at the base absorbs, see plastic.h.
#define PLASTIC_LINEAR 0
#define PLASTIC_NONLINEAR 1

// Variants of Ward's BSDF.
#define WARD_ORIGINAL 0
#define WARD_DUER 1
#define WARD_BALANCED 2

// Variants of the rough diffuse BSDF.
#define ROUGHDIFFUSE_FULL 0
#define ROUGHDIFFUSE_FAST 1

// Variants of hair, as bits.
#define HAIR_ALONG_V 1      // the fibre is along increasing v, else along increasing u
#define HAIR_OFFSET_BY_V 2  // v is across the fibre, else its normal tells the offset
#define HAIR_OF_COLOUR 4    // absorption by the colour

// Variants of Disney's BRDF, as bits.
#define DISNEY_WITHOUT_MICROFACETS 1
#define DISNEY_LUMINANCE_TINT 2  // tints have luminance 1, not 1 by Disney's own weights

// The families that use each field. A field that no family in the scene uses is not read and keeps its value
// of black_closure. Families of tests may use all fields.
#define FAMILY_BIT(name, NAME, number, properties, text) | ((ulong)1 << (number))
#define EXTRA_FAMILIES ((ulong)0 EXTRA_BSDF_FAMILIES(FAMILY_BIT))
#define USERS(families) ((families) | EXTRA_FAMILIES)
#define ONLY(NAME) ((ulong)1 << FAMILY_##NAME)
#define ROUGH_CONDUCTORS (ONLY(ROUGHCONDUCTOR_GGX) | ONLY(ROUGHCONDUCTOR_BECKMANN))
#define ROUGH_DIELECTRICS (ONLY(ROUGHDIELECTRIC_GGX) | ONLY(ROUGHDIELECTRIC_BECKMANN))
#define DISPERSING (ONLY(DIELECTRIC) | ROUGH_DIELECTRICS | OPENPBRS_LAYERED)
#define CONDUCTORS (ONLY(CONDUCTOR) | ROUGH_CONDUCTORS)
#define DIELECTRICS (ONLY(DIELECTRIC) | ONLY(THINDIELECTRIC) | ROUGH_DIELECTRICS)
#define ROUGH_PLASTICS (ONLY(ROUGHPLASTIC_GGX) | ONLY(ROUGHPLASTIC_BECKMANN))
#define PLASTICS (ONLY(PLASTIC) | ROUGH_PLASTICS)
#define DIFFUSE_AND_LOBE (PLASTICS | ONLY(WARD) | ONLY(BLINNPHONG) | ONLY(MICROFACET_DIFFUSE))
#define PRINCIPLED_SOLIDS (ONLY(PRINCIPLED) | ONLY(PRINCIPLED_TRANSMITTING))
#define OPENPBRS_LAYERED (ONLY(OPENPBR_LAYERED) | ONLY(OPENPBR_FILM))
#define OPENPBRS (ONLY(OPENPBR) | OPENPBRS_LAYERED)
#define METALS_AND_BASES (PRINCIPLED_SOLIDS | ONLY(DISNEY))
#define PRINCIPLEDS (PRINCIPLED_SOLIDS | ONLY(PRINCIPLEDTHIN))
#define DISNEYS (PRINCIPLEDS | ONLY(DISNEY))
#define USERS_variant                                                                               \
  USERS(PLASTICS | ONLY(WARD) | ONLY(ROUGHDIFFUSE) | ONLY(PRINCIPLED_TRANSMITTING) | ONLY(DISNEY) | \
        OPENPBRS | ONLY(HAIR))
#define USERS_curve USERS(ROUGH_PLASTICS | OPENPBRS | ONLY(MEASURED))
#define USERS_curve_rows USERS(ROUGH_PLASTICS | OPENPBRS)
#define USERS_film_rows USERS(ONLY(OPENPBR_FILM))
#define USERS_film USERS(ONLY(OPENPBR_FILM))
#define USERS_film_thickness USERS(ONLY(OPENPBR_FILM))
#define USERS_first_lobe USERS(ONLY(PHASE))
#define USERS_internal USERS(ONLY(PLASTIC) | OPENPBRS)
#define USERS_specular_rate USERS(PRINCIPLEDS)
#define USERS_diffuse_rate USERS(ONLY(PLASTIC) | PRINCIPLEDS | OPENPBRS_LAYERED)
#define USERS_clearcoat_rate USERS(PRINCIPLEDS | OPENPBRS_LAYERED)
#define USERS_diff_trans_rate USERS(ONLY(PRINCIPLEDTHIN) | OPENPBRS_LAYERED)
#define USERS_tilt USERS(ONLY(HAIR))
#define USERS_offset USERS(ONLY(HAIR))
#define USERS_coat_normal USERS(OPENPBRS_LAYERED)
#define USERS_diffuse                                                                                     \
  USERS(ONLY(DIFFUSE) | ONLY(ROUGHDIFFUSE) | ONLY(DIFFTRANS) | ONLY(PHONG) | DIFFUSE_AND_LOBE | DISNEYS | \
        OPENPBRS | ONLY(HAIR))
#define USERS_specular \
  USERS(ONLY(PHONG) | DIFFUSE_AND_LOBE | CONDUCTORS | DIELECTRICS | OPENPBRS | ONLY(MEASURED))
#define USERS_transmitted USERS(DIELECTRICS | ONLY(DIFFTRANS) | OPENPBRS_LAYERED | ONLY(HAIR))
#define USERS_eta USERS(CONDUCTORS | OPENPBRS_LAYERED)
#define USERS_k USERS(CONDUCTORS | OPENPBRS_LAYERED)
#define USERS_ior \
  USERS(DIELECTRICS | PLASTICS | ONLY(MICROFACET_DIFFUSE) | PRINCIPLEDS | OPENPBRS | ONLY(HAIR))
#define USERS_alpha_u                                                                                   \
  USERS(ROUGH_CONDUCTORS | ROUGH_DIELECTRICS | ROUGH_PLASTICS | ONLY(WARD) | ONLY(MICROFACET_DIFFUSE) | \
        ONLY(ROUGHDIFFUSE) | ONLY(HAIR))
#define USERS_alpha_v USERS(ROUGH_CONDUCTORS | ROUGH_DIELECTRICS | ONLY(WARD) | ONLY(HAIR))
#define USERS_exponent USERS(ONLY(PHONG) | ONLY(BLINNPHONG))
#define USERS_roughness USERS(DISNEYS | OPENPBRS)
#define USERS_anisotropic USERS(DISNEYS | OPENPBRS_LAYERED | ONLY(MEASURED))
#define USERS_metallic USERS(METALS_AND_BASES | OPENPBRS)
#define USERS_spec_trans \
  USERS(ONLY(PRINCIPLED_TRANSMITTING) | ONLY(PRINCIPLEDTHIN) | ONLY(DISNEY) | OPENPBRS_LAYERED)
#define USERS_diff_trans USERS(ONLY(PRINCIPLEDTHIN) | OPENPBRS_LAYERED)
#define USERS_spec_tint USERS(DISNEYS | OPENPBRS)
#define USERS_specular_level USERS(ONLY(DISNEY) | OPENPBRS)
#define USERS_sheen USERS(DISNEYS | OPENPBRS_LAYERED)
#define USERS_sheen_tint USERS(DISNEYS | OPENPBRS_LAYERED)
#define USERS_flatness USERS(DISNEYS | OPENPBRS_LAYERED)
#define USERS_clearcoat USERS(METALS_AND_BASES | OPENPBRS_LAYERED)
#define USERS_clearcoat_gloss USERS(METALS_AND_BASES | OPENPBRS_LAYERED)
#define USERS_subsurface USERS(OPENPBRS_LAYERED)

#define ZERO_int 0
#define ZERO_float 0.0f
#define ZERO_vec3 make_vec3(0.0f, 0.0f, 0.0f)
#define ZERO_FIELD(a, type, name) c.name = ZERO_##type;
FN Closure black_closure(void) {
  Closure c;
  CLOSURE_FIELDS(ZERO_FIELD, )
  return c;
}
#undef ZERO_FIELD

// Masks of families. A kernel is compiled for the families in FAMILIES, which the build defines.
#define EVERY_FAMILY ((ulong)0 BSDF_FAMILIES(FAMILY_BIT))
#ifndef FAMILIES
  #define FAMILIES EVERY_FAMILY
#endif
// A copy of the mask, since it must not be expanded within the expansion of BSDF_FAMILIES.
ENUM_OF_ULONG{COMPILED_FAMILIES = FAMILIES};
// HAS_FAMILY is a compile-time constant: compilers drop the code behind `if (HAS_FAMILY(PHONG))` where it is
// false.
#define HAS_FAMILY(NAME) ((COMPILED_FAMILIES & ONLY(NAME)) != 0u)

FN ulong compiled_families(void) { return FAMILIES; }

#define FAMILY_WITH(name, NAME, number, properties, text) \
  | (((properties)&wanted) != 0 ? (ulong)1 << (number) : (ulong)0)
/// The families with any of the wanted properties.
FN ulong families_with(int wanted) { return (ulong)0 BSDF_FAMILIES(FAMILY_WITH); }
#undef FAMILY_WITH

#define BRANCHING_FAMILY(name, NAME) | ONLY(NAME)
FN ulong branching_families(void) {
  return ((ulong)0 BRANCHING_FAMILIES(BRANCHING_FAMILY)) & compiled_families();
}
#undef BRANCHING_FAMILY

/// Whether the closure is of one of the families. Words of 32 bits keep lanes as wide as others.
FN bool is_among(Closure c, ulong families) {
  const uint word = c.family < 32 ? (uint)families : (uint)(families >> 32);
  return ((word >> (c.family & 31)) & 1u) != 0u;
}

/// Whether light from behind is transmitted. Some closures of the principled families do not transmit; solid
/// ones of OpenPBR scatter below the surface what these call diffuse transmission.
FN bool lets_light_through(Closure c) {
  const bool by_amount = is_among(c, ONLY(PRINCIPLED) | ONLY(PRINCIPLEDTHIN) | OPENPBRS_LAYERED);
  const bool solid = is_among(c, OPENPBRS_LAYERED) & ((c.variant & OPENPBR_THIN) == 0);
  const float amount = c.spec_trans + (solid ? 0.0f : c.diff_trans);
  return is_among(c, families_with(TRANSMITS)) & (!by_amount | (amount > 0.0f));
}

/// Whether a coat with a normal of its own also reflects light from below the horizon of the base. If the
/// base does not end the light from there, it does not: the base's normal decides what goes inside.
FN bool has_open_coat(Closure c) {
  const bool own = (c.variant & (OPENPBR_OWN_COAT | OPENPBR_WALKS)) == OPENPBR_OWN_COAT;
  const bool layered = is_among(c, OPENPBRS_LAYERED), through = lets_light_through(c);
  return layered & own & !through;
}

/// Whether light from below the horizon of the shading normal matters.
FN bool is_lit_all_around(Closure c) {
  const bool through = lets_light_through(c), open = has_open_coat(c);
  return through | open;
}

FN bool has_closed_form(Closure c) { return is_among(c, families_with(CLOSED_FORM)); }

/// Whether the orientation of its frame about the normal matters.
FN bool is_anisotropic(Closure c) {
  return (c.alpha_u != c.alpha_v) | (c.anisotropic != 0.0f) | is_among(c, ONLY(HAIR));
}

// The families with control lobes for polygon lights: X(name, NAME); their files define `name`_control, see
// control_lobes.h.
#ifndef EXTRA_LTC_FAMILIES
  #define EXTRA_LTC_FAMILIES(X)
#endif
#define LTC_FAMILIES(X)                               \
  X(roughconductor_ggx, ROUGHCONDUCTOR_GGX)           \
  X(roughconductor_beckmann, ROUGHCONDUCTOR_BECKMANN) \
  X(plastic, PLASTIC)                                 \
  X(roughplastic_ggx, ROUGHPLASTIC_GGX)               \
  X(roughplastic_beckmann, ROUGHPLASTIC_BECKMANN)     \
  X(microfacet_diffuse, MICROFACET_DIFFUSE)           \
  X(principled, PRINCIPLED)                           \
  X(disney, DISNEY)                                   \
  X(openpbr, OPENPBR)                                 \
  EXTRA_LTC_FAMILIES(X)
#define LTC_FAMILY_BIT(name, NAME) | ONLY(NAME)
FN ulong ltc_families(void) { return (ulong)0 LTC_FAMILIES(LTC_FAMILY_BIT); }

/// Approximate albedo, from the closure's colours.
FN vec3 closure_albedo(Closure c) {
  // The boundary of a coat reflects this much along the normal.
  const bool coated = is_among(c, PLASTICS | ONLY(MICROFACET_DIFFUSE) | OPENPBRS);
  const float step = (c.ior - 1.0f) / (c.ior + 1.0f);
  return add(c.diffuse, scale(c.specular, coated ? step * step : 1.0f));
}

// --- Results of a family's functions. Directions are in the frame of the shading normal, whose z axis is on
// the side of wo; f is in 1/sr, pdfs are per solid angle.

#define BSDF_VALUE_FIELDS(F, a)                             \
  F(a, vec3, f_cos) /* f times the absolute cosine of wi */ \
  F(a, float, pdf)  /* pdf with which the family samples wi */
LANE_RECORD(BsdfValue, BsdfValues, bsdf_value, BSDF_VALUE_FIELDS)

#define BSDF_SAMPLE_FIELDS(F, a)                                                                   \
  F(a, vec3, wi)                                                                                   \
  F(a, vec3, weight) /* f cos / pdf */                                                             \
  F(a, float, pdf)   /* 0: no direction; DELTA_PDF: a delta direction, for which eval returns 0 */ \
  F(a, float, eta)   /* refractive index on wi's side over that on wo's side; 1 if reflected */
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

/// A sample of the reflected direction wi, given the family's own eval.
FN BsdfSample sample_of_value(vec3 wi, BsdfValue value) {
  BsdfSample s = no_bsdf_sample();
  s.wi = wi;
  s.pdf = value.pdf;
  s.weight = scale(value.f_cos, 1.0f / (s.pdf > 0.0f ? s.pdf : 1.0f));
  return s;
}

PENUMBRA_NAMESPACE_END
#endif
