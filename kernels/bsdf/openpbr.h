// The surface of OpenPBR 1.1: a metal and a dielectric base with a diffuse or transmitting inside, below a
// thin film, below a coat, below fuzz. `openpbr` is the base alone, opaque and isotropic; `openpbr_layered`
// is all but the film, and `openpbr_film` is all.
//
// GGX microfacets reflect by Fresnel's equations (dielectric) or by F82 (metal: Kutz et al. 2021). What a
// metal's microfacets lose between each other comes back as a separable lobe (Kulla and Conty 2017), which is
// reciprocal. All else is dimmed by what the layer above it reflects for wo, as in the standard and in
// Cycles, which is as exact in energy but not reciprocal: what is below coat, fuzz and a dielectric's
// microfacets. Of the light below these, their further reflections have the share that makes up for the lost
// ones. Transmission and the reflection of what transmits are divided by what a single scattering leaves.
//
// With OPENPBR_OWN_COAT the coat's microfacets, its albedo and the ways through it are those about its own
// normal, for wo and wi. Fuzz and what is below the coat have the normal of the base. See has_open_coat.
//
// What the film reflects of a channel replaces Fresnel's reflectance on its share `film` of the dielectric;
// what it adds to a metal of such a reflectance along the normal is added to F82. See thin_film.h.
//
// Of the opaque base, subsurface has the share `diff_trans` and the colour `subsurface`. A thin wall scatters
// it evenly, the share `diff_trans_rate` to the other side. With OPENPBR_WALKS its light goes evenly into the
// medium inside, which gives it its colour (interiors.h); such directions have DELTA_PDF, since only walks
// reach what is behind. Otherwise it is reflected diffusely.
//
// With OPENPBR_GLTF, `anisotropic` is KHR_materials_anisotropy's strength. `specular` and `specular_level`
// are KHR_materials_specular's: they change nothing of a metal, the level is a factor of all that the
// dielectric reflects, and what it does not reflect outside it transmits. Fuzz takes from what is below the
// albedo of its brightest channel (KHR_materials_sheen).
//
// Fields: `diffuse` base colour, `spec_tint` base weight, `flatness` diffuse roughness, `specular` colour and
// `specular_level` weight of reflection (in `ior`, too, unless OPENPBR_WEIGHT_TINTS), `internal` mean Fresnel
// reflectance of the base, `transmitted` colour of light that went in and out, `clearcoat` weight,
// `clearcoat_gloss` roughness, `eta` colour, `clearcoat_rate` index and `diffuse_rate` darkening of the coat,
// `sheen` weight, `sheen_tint` roughness and `k` colour of the fuzz. `curve` is that of FacetCurves
// (scenes/bsdfs/facet_albedo.h).
#ifndef PENUMBRA_OPENPBR_H
#define PENUMBRA_OPENPBR_H
#include "kernels/bsdf/control_lobes.h"
#include "kernels/bsdf/dielectric.h"
#include "kernels/bsdf/disney_lobes.h"
#include "kernels/bsdf/fuzz.h"
#include "kernels/bsdf/roughplastic.h"
#include "kernels/bsdf/thin_film.h"
#include "kernels/scene.h"

PENUMBRA_NAMESPACE_BEGIN

/// Where a cosine is between the knots of a curve, which are equidistant in its fourth root.
typedef struct {
  int knot;
  float w;
} CurvePlace;

FN CurvePlace curve_place(float cosine) {
  const float x = SQRT(SQRT(clamp_f(cosine, 0.0f, 1.0f))) * (float)(CURVE_KNOTS - 1);
  CurvePlace place;
  place.knot = min_i((int)x, CURVE_KNOTS - 2);
  place.w = x - (float)place.knot;
  return place;
}

/// Rows of `set` at a place in [0, 1]. `sets` is a constant.
FN CurveRows facet_rows(Closure c, int sets, int set, float place) {
  const int count = c.curve_rows / sets, last = max_i(count - 1, 0);  // other families may have no rows
  const float x = clamp_f(place, 0.0f, 1.0f) * (float)last;
  const int row = min_i((int)x, last), next = min_i(row + 1, last),
            start = c.curve + set * count * CURVE_STRIDE;
  CurveRows rows;
  rows.first = start + row * CURVE_STRIDE;
  rows.second = start + next * CURVE_STRIDE;
  rows.w = x - (float)row;
  return rows;
}

/// The same rows of the set that is `further` sets on. `sets` is a constant.
FN CurveRows rows_further(Closure c, int sets, CurveRows rows, int further) {
  const int offset = further * (c.curve_rows / sets) * CURVE_STRIDE;
  rows.first += offset;
  rows.second += offset;
  return rows;
}

/// Rows by roughness are equidistant in the fourth root of alpha from LEAST_FACET_ALPHA to 1.
FN float facet_place(float alpha) {
  return (SQRT(SQRT(clamp_f(alpha, LEAST_FACET_ALPHA, 1.0f))) - FIRST_FACET_PLACE) /
         (1.0f - FIRST_FACET_PLACE);
}

FN float facet_curve(const PRIVATE Scene* scene, CurveRows rows, CurvePlace at) {
  return mix_f(between_rows(scene, rows, at.knot), between_rows(scene, rows, at.knot + 1), at.w);
}

/// What the base's microfacets reflect by Fresnel's equations, and would if they reflected all light. Both
/// are in one number, for half the gathers.
typedef struct {
  float reflected, plain;
} FacetAlbedos;
FN FacetAlbedos facet_albedos(float both) {
  const uint bits = FLOAT_BITS(both);
  FacetAlbedos a;
  a.reflected = (float)(int)(bits & (uint)OPENPBR_PACKED) * (1.0f / (float)OPENPBR_PACKED);
  a.plain = (float)(int)(bits >> OPENPBR_PACKED_BITS) * (1.0f / (float)OPENPBR_PACKED);
  return a;
}
/// With a film, per channel: what microfacets reflect, and what they reflect or refract.
typedef struct {
  vec3 reflected, scattered;
} FilmAlbedos;

FN FacetAlbedos mix_albedos(FacetAlbedos a, FacetAlbedos b, float w) {
  a.reflected = mix_f(a.reflected, b.reflected, w);
  a.plain = mix_f(a.plain, b.plain, w);
  return a;
}
/// At an offset in the rows.
FN FacetAlbedos albedos_between_rows(const PRIVATE Scene* scene, CurveRows rows, int at) {
  return mix_albedos(facet_albedos(scene->curves[rows.first + at]),
                     facet_albedos(scene->curves[rows.second + at]), rows.w);
}
FN FacetAlbedos base_albedos(const PRIVATE Scene* scene, CurveRows rows, CurvePlace at) {
  return mix_albedos(albedos_between_rows(scene, rows, at.knot),
                     albedos_between_rows(scene, rows, at.knot + 1), at.w);
}

/// The rows of the base for direction w: by roughness, or by azimuth.
FN CurveRows base_rows(Closure c, Microfacets m, bool layered, vec3 w) {
  if (!layered) return facet_rows(c, OPENPBR_PLAIN_SETS, OPENPBR_BASE, facet_place(m.alpha_u));
  const float x2 = w.x * w.x, y2 = w.y * w.y, sine2 = x2 + y2;
  const float across = sine2 > 0.0f ? y2 / sine2 : 0.0f;
  const float alpha = SQRT(mix_f(m.alpha_u * m.alpha_u, m.alpha_v * m.alpha_v, across));
  const bool by_azimuth = (c.variant & OPENPBR_BY_AZIMUTH) != 0;
  return facet_rows(c, OPENPBR_SETS, OPENPBR_BASE, by_azimuth ? across : facet_place(alpha));
}

/// 1 / x for x above 0, else 0.
FN float inverse_or_0(float x) { return x > 0.0f ? 1.0f / x : 0.0f; }

/// The share that microfacets of mean reflectance `f` and albedo `plain` reflect of what they do not reflect
/// at once, if it is as if they did not: geometric series of Kulla and Conty 2017.
FN float many_reflections(float f, float plain) {
  return f * f * plain / max_f(1.0f - f * (1.0f - plain), 1e-6f);
}

/// Reflectance of a metal: Schlick's from `base` to 1, less an amount that makes it `tint` times that at the
/// cosine 1 / 7 (F82).
FN float metal_dip(float base, float tint) {
  // Over (1 / 7) (6 / 7)^6; Schlick's weight there is (6 / 7)^5.
  return (base + (1.0f - base) * 0.46266435f) * (1.0f - tint) * 17.6514166f;
}
FN vec3 metal_fresnel(vec3 base, vec3 dip, float cosine) {
  const float m = clamp_f(1.0f - cosine, 0.0f, 1.0f), m5 = schlick_weight(cosine), d = (1.0f - m) * (m5 * m);
  return make_vec3(max_f(mix_f(base.x, 1.0f, m5) - dip.x * d, 0.0f),
                   max_f(mix_f(base.y, 1.0f, m5) - dip.y * d, 0.0f),
                   max_f(mix_f(base.z, 1.0f, m5) - dip.z * d, 0.0f));
}
/// Its mean over a cosine-weighted hemisphere: those of m^5 and mu m^6 are 1 / 21 and 1 / 126.
FN float mean_metal(float base, float dip) {
  return max_f(mix_f(base, 1.0f, 1.0f / 21.0f) - dip * (1.0f / 126.0f), 0.0f);
}

/// pi f of rough diffuse reflection (Portsmouth, Kutz and Hill 2024, "EON"), without the factor of its colour
/// for single scattering and with that for multiple scattering.
typedef struct {
  float once, more, mean;
} RoughDiffuse;
FN float rough_diffuse_albedo(float cosine, float roughness) {
  const float c = clamp_f(cosine, 1e-4f, 1.0f), s = safe_sqrt(1.0f - c * c), angle = atan2_f(s, c);
  const float g = s * (angle - s * c) + (2.0f / 3.0f) * (s / c * (1.0f - s * s * s) - s);
  return (1.0f + roughness * INV_PI_F * g) / (1.0f + 0.287793409f * roughness);  // 1 / 2 - 2 / (3 pi)
}
FN RoughDiffuse rough_diffuse(float roughness, vec3 wo, vec3 wi) {
  const float s = dot3(wo, wi) - wo.z * wi.z, over = 1.0f / max_f(max_f(wo.z, wi.z), 1e-6f);
  const float a = 1.0f / (1.0f + 0.287793409f * roughness);
  const float mean = a * (1.0f + 0.072488212f * roughness);  // 2 / 3 - 28 / (15 pi)
  RoughDiffuse d;
  d.once = a * (1.0f + roughness * s * (s > 0.0f ? over : 1.0f));
  d.more = (1.0f - rough_diffuse_albedo(wo.z, roughness)) * (1.0f - rough_diffuse_albedo(wi.z, roughness)) *
           inverse_or_0(1.0f - mean);
  d.mean = mean;
  return d;
}
FN float rough_diffuse_value(RoughDiffuse d, float colour) {
  const float more = colour * colour * d.mean / max_f(1.0f - colour * (1.0f - d.mean), 1e-6f);
  return max_f(colour * d.once + more * d.more, 0.0f);
}

FN vec3 uniform_vec3(float x) { return make_vec3(x, x, x); }

/// The parts that depend on wo alone.
typedef struct {
  Microfacets facets, coat_facets;
  CurveRows rows;
  FilmBlocks film;
  vec3 reflected, mean_reflected;  // what microfacets reflect of light for wo, and of all
  float plain, mean_plain;         // ... without Fresnel's factor
  float dielectric, metal;         // weights; those below are included
  vec3 tint, raise, metal_base, dip;
  float weight;      // of the dielectric's reflection
  bool fades;        // whether the tint does
  vec3 base_colour;  // of the diffuse base
  vec3 again;        // share of the light below the dielectric that its microfacets reflect
  vec3 metal_again;  // of what a metal's microfacets do not reflect at once
  // Of layered ones.
  bool inside, thin;
  float opaque;               // share of the dielectric
  vec3 glass;                 // that of what transmits, times what its single scattering lacks
  float coat, fuzz;           // weights
  vec3 coat_normal, coat_wo;  // wo in a frame about that
  bool open_coat;
  Ltc fuzz_ltc;                    // but with OPENPBR_GLTF
  float fuzz_reflects;             // its albedo for wo
  vec3 sub_reflected, sub_passed;  // of the opaque base's light: colours of what subsurface scatters
  vec3 below;                      // what coat and fuzz leave of the base; without the coat's absorption
  float above_coat;                // what the fuzz leaves of the coat
  // Sampling probabilities; the base's microfacets transmit with `transmits` times the transmittance.
  float share_diffuse, share_facets, share_coat, share_fuzz, share_sub, transmits;
} OpenPbr;

/// A tinted reflectance is slope * F + raise, where F is Fresnel's.
typedef struct {
  float slope, raise;
} Tint;
/// If the tint fades, it is only of F0 (1 - S) where F is S + F0 (1 - S) (glTF 2.0, appendix B). Written in F
/// it does not multiply the errors of tables, though it may be above 1.
FN Tint tint_of(float colour, float along_normal, bool fades) {
  const float least = min_f(colour * along_normal, 1.0f);  // all is reflected
  const float slope = (1.0f - least) / max_f(1.0f - along_normal, 1e-3f);
  Tint t;
  t.slope = fades ? slope : colour;
  t.raise = fades ? least - along_normal * slope : 0.0f;
  return t;
}

/// What the dielectric reflects. `all`: what would be reflected without Fresnel's factor.
FN vec3 tinted(OpenPbr p, vec3 reflected, float all) {
  return make_vec3(p.weight * max_f(reflected.x * p.tint.x + all * p.raise.x, 0.0f),
                   p.weight * max_f(reflected.y * p.tint.y + all * p.raise.y, 0.0f),
                   p.weight * max_f(reflected.z * p.tint.z + all * p.raise.z, 0.0f));
}

/// What a medium of this transmittance leaves of light that goes through it `times` times; textures may be
/// above 1.
FN float transmittance_power(float transmittance, float times) {
  return exp_f(times * log_f(clamp_f(transmittance, 1e-20f, 1.0f)));
}
FN vec3 transmittance_power3(vec3 transmittance, float times) {
  return make_vec3(transmittance_power(transmittance.x, times), transmittance_power(transmittance.y, times),
                   transmittance_power(transmittance.z, times));
}

/// What passes a boundary, of light that a base of this albedo returns whenever the boundary reflects `back`.
FN float left_after(float back, float albedo) {
  return (1.0f - back) / max_f(1.0f - back * min_f(albedo, 1.0f), 1e-6f);
}

/// What the microfacets of the dielectric leave of the light. Where the tint fades, that is without colour,
/// as glTF defines.
FN vec3 left_by_dielectric(OpenPbr p) {
  const vec3 reflected = tinted(p, p.reflected, p.plain);
  const vec3 taken = select3(p.fades, uniform_vec3(max_component(reflected)), reflected);
  return sub(uniform_vec3(1.0f), taken);
}
/// For a channel: the mean of the microfacets' further reflections, over that of the light below, in which
/// they are. `boundary`: the mean of their reflectance; `reflected`: of what they reflect.
FN float further_share(OpenPbr p, float boundary, float reflected, float tint, float weight) {
  const float further = many_reflections(boundary, p.mean_plain) * (1.0f - p.mean_plain);
  return tint * (weight * further / max_f(1.0f - reflected, 1e-6f));
}
/// Where the tint fades, each reflection is tinted.
FN vec3 further_shares(OpenPbr p, vec3 boundary) {
  const bool fades = p.fades;
  const vec3 each = select3(fades, tinted(p, boundary, 1.0f), boundary);
  const vec3 left = tinted(p, p.mean_reflected, p.mean_plain);
  const vec3 reflected = select3(fades, uniform_vec3(max_component(left)), p.mean_reflected);
  const vec3 tint = select3(fades, uniform_vec3(1.0f), p.tint);
  const float weight = fades ? 1.0f : p.weight;
  return make_vec3(further_share(p, each.x, reflected.x, tint.x, weight),
                   further_share(p, each.y, reflected.y, tint.y, weight),
                   further_share(p, each.z, reflected.z, tint.z, weight));
}
/// The same of a base of this colour, with their further reflections.
FN vec3 below_dielectric(OpenPbr p, vec3 base) {
  return mul(left_by_dielectric(p), make_vec3(mix_f(base.x, 1.0f, p.again.x), mix_f(base.y, 1.0f, p.again.y),
                                              mix_f(base.z, 1.0f, p.again.z)));
}
/// ... and what of it subsurface passes on.
FN vec3 passed_below(OpenPbr p, vec3 passed) {
  return mul(left_by_dielectric(p), mul(passed, sub(uniform_vec3(1.0f), p.again)));
}

/// The three numbers of facet_albedos in the film's block.
FN FilmAlbedos film_albedos_at(const PRIVATE Scene* scene, int at) {
  const FacetAlbedos x = facet_albedos(scene->curves[at]), y = facet_albedos(scene->curves[at + 1]),
                     z = facet_albedos(scene->curves[at + 2]);
  FilmAlbedos a;
  a.reflected = make_vec3(x.reflected, y.reflected, z.reflected);
  a.scattered = make_vec3(x.plain, y.plain, z.plain);
  return a;
}
FN FilmAlbedos mix_film_albedos(FilmAlbedos a, FilmAlbedos b, float w) {
  a.reflected = mix3(a.reflected, b.reflected, w);
  a.scattered = mix3(a.scattered, b.scattered, w);
  return a;
}
/// `rows` are those of the base.
FN FilmAlbedos film_albedos(const PRIVATE Scene* scene, Closure c, FilmBlocks film, CurveRows rows,
                            int knot) {
  const int first = FILM_REFLECTANCES + 3 * (rows.first - c.curve + knot),
            second = FILM_REFLECTANCES + 3 * (rows.second - c.curve + knot);
  const FilmAlbedos thin = mix_film_albedos(film_albedos_at(scene, film.first + first),
                                            film_albedos_at(scene, film.first + second), rows.w);
  const FilmAlbedos thick = mix_film_albedos(film_albedos_at(scene, film.second + first),
                                             film_albedos_at(scene, film.second + second), rows.w);
  return mix_film_albedos(thin, thick, film.w);
}

/// The reflectance of the base's microfacets, by Fresnel's equations and with its film; `film` is a constant.
FN vec3 base_reflectances(const PRIVATE Scene* scene, Closure c, OpenPbr p, bool film, float cosine,
                          float fresnel) {
  if (!film) return uniform_vec3(fresnel);
  const vec3 of_film = film_over_dielectric(scene, p.film, film_place(cosine));
  const bool partly = fresnel < 1.0f;  // the table does not know where total reflection begins
  return select3(partly, mix3(uniform_vec3(fresnel), of_film, c.film), uniform_vec3(1.0f));
}
FN vec3 metal_reflectances(const PRIVATE Scene* scene, Closure c, OpenPbr p, bool film, float cosine) {
  const vec3 plain = metal_fresnel(p.metal_base, p.dip, cosine);
  return film ? film_over_metal(scene, p.film, film_place(cosine), p.metal_base, plain, c.film) : plain;
}
/// Of two alike boundaries of a thin wall.
FN vec3 reflectances_of_two(vec3 r) {
  return make_vec3(reflectance_of_two(r.x), reflectance_of_two(r.y), reflectance_of_two(r.z));
}
/// Whether what transmits takes the light that its boundary does not show: outside, of glTF.
FN bool passes_the_rest(Closure c, OpenPbr p) { return ((c.variant & OPENPBR_GLTF) != 0) & !p.inside; }

/// The probability of reflection that samples have, for these reflectances.
FN float chance_of_reflection(Closure c, OpenPbr p, bool film, vec3 reflectances) {
  if (film) return (reflectances.x + reflectances.y + reflectances.z) * (1.0f / 3.0f);
  return passes_the_rest(c, p) ? max_component(tinted(p, reflectances, 1.0f)) : reflectances.x;
}

/// `layered` and `film` are constants: which of the three families it is.
FN OpenPbr openpbr_of(const PRIVATE Scene* scene, Closure c, bool layered, bool film, vec3 wo) {
  const int sets = layered ? OPENPBR_SETS : OPENPBR_PLAIN_SETS;
  const vec3 white = uniform_vec3(1.0f);
  OpenPbr p;
  p.facets = openpbr_microfacets(c.roughness, layered ? c.anisotropic : 0.0f);
  const bool gltf = (c.variant & OPENPBR_GLTF) != 0;
  if (layered) {
    const Microfacets raised = gltf_microfacets(c.roughness, c.anisotropic);
    p.facets.alpha_u = gltf ? raised.alpha_u : p.facets.alpha_u;
    p.facets.alpha_v = gltf ? raised.alpha_v : p.facets.alpha_v;
  }
  p.rows = base_rows(c, p.facets, layered, wo);
  const CurvePlace at = curve_place(wo.z);
  const FacetAlbedos albedos = base_albedos(scene, p.rows, at);
  const FacetAlbedos means = albedos_between_rows(scene, p.rows, CURVE_KNOTS);
  p.reflected = uniform_vec3(albedos.reflected);
  p.plain = albedos.plain;
  p.mean_reflected = uniform_vec3(means.reflected);
  p.mean_plain = means.plain;
  vec3 internal = uniform_vec3(c.internal);
  FilmAlbedos with_film;
  with_film.reflected = with_film.scattered = white;
  p.film.first = p.film.second = 0;
  p.film.w = 0.0f;
  if (film) {
    p.film = film_blocks(c, c.curve_rows / sets);
    const bool there = c.film_rows > 0;  // lanes of other families have none
    CurveRows rows = p.rows;
    rows.first = there ? rows.first : c.curve;
    rows.second = there ? rows.second : c.curve;
    with_film = mix_film_albedos(film_albedos(scene, c, p.film, rows, at.knot),
                                 film_albedos(scene, c, p.film, rows, at.knot + 1), at.w);
    const FilmAlbedos mean = film_albedos(scene, c, p.film, rows, CURVE_KNOTS);
    p.reflected = mix3(p.reflected, with_film.reflected, c.film);
    p.mean_reflected = mix3(p.mean_reflected, mean.reflected, c.film);
    internal = mix3(internal, film_over_dielectric(scene, p.film, film_mean()), c.film);
  }

  p.metal = gltf ? c.metallic : c.metallic * c.specular_level;
  p.dielectric = 1.0f - c.metallic;
  p.weight = (c.variant & OPENPBR_WEIGHT_TINTS) != 0 ? c.specular_level : 1.0f;
  p.fades = (c.variant & OPENPBR_TINT_FADES) != 0;
  const float along_normal = normal_reflectance(c.ior);
  const Tint red = tint_of(c.specular.x, along_normal, p.fades),
             green = tint_of(c.specular.y, along_normal, p.fades),
             blue = tint_of(c.specular.z, along_normal, p.fades);
  p.tint = make_vec3(red.slope, green.slope, blue.slope);
  p.raise = make_vec3(red.raise, green.raise, blue.raise);
  p.metal_base = p.base_colour = scale(c.diffuse, c.spec_tint);
  const vec3 edge = select3(gltf, white, c.specular);
  p.dip = make_vec3(metal_dip(p.metal_base.x, edge.x), metal_dip(p.metal_base.y, edge.y),
                    metal_dip(p.metal_base.z, edge.z));
  vec3 metal_mean = make_vec3(mean_metal(p.metal_base.x, p.dip.x), mean_metal(p.metal_base.y, p.dip.y),
                              mean_metal(p.metal_base.z, p.dip.z));
  if (film) metal_mean = film_over_metal(scene, p.film, film_mean(), p.metal_base, metal_mean, c.film);
  p.metal_again =
      make_vec3(many_reflections(metal_mean.x, p.mean_plain), many_reflections(metal_mean.y, p.mean_plain),
                many_reflections(metal_mean.z, p.mean_plain));
  p.again = further_shares(p, internal);

  p.inside = layered & ((c.variant & OPENPBR_INSIDE) != 0);
  p.thin = layered & ((c.variant & OPENPBR_THIN) != 0);
  p.glass = make_vec3(0.0f, 0.0f, 0.0f);
  p.opaque = 1.0f;
  p.coat = p.fuzz = p.share_coat = p.share_fuzz = p.share_sub = p.transmits = 0.0f;
  p.sub_reflected = p.sub_passed = make_vec3(0.0f, 0.0f, 0.0f);
  p.above_coat = 1.0f;
  p.below = white;
  p.coat_facets = p.facets;
  p.coat_normal = make_vec3(0.0f, 0.0f, 1.0f);
  p.coat_wo = wo;
  p.open_coat = false;
  p.fuzz_ltc = fuzz_ltc(1.0f, 0.0f);
  p.fuzz_reflects = 0.0f;

  // What is reflected of light for wo, roughly.
  const vec3 from_dielectric = tinted(p, p.reflected, p.plain);
  const vec3 at_once = add_scaled(scale(from_dielectric, p.dielectric), p.metal * p.plain, metal_mean);
  vec3 base = p.base_colour;
  const bool walks = layered & ((c.variant & OPENPBR_WALKS) != 0);
  if (layered) {
    const float amount = p.inside ? 0.0f : c.diff_trans, through = walks ? 1.0f : c.diff_trans_rate;
    p.sub_reflected = scale(c.subsurface, amount * (1.0f - through));
    p.sub_passed = scale(select3(walks, white, c.subsurface), amount * through);
    base = add(scale(base, 1.0f - amount), p.sub_reflected);
  }
  const vec3 returned = below_dielectric(p, base);
  vec3 diffuse = scale(returned, p.dielectric);
  diffuse = add_scaled(diffuse, p.metal * (1.0f - p.plain), p.metal_again);
  float facets = luminance(at_once);
  if (layered) {
    const CurveRows scattered = rows_further(c, sets, p.rows, OPENPBR_SCATTERED - OPENPBR_BASE);
    vec3 each_once = uniform_vec3(p.thin ? p.plain : facet_curve(scene, scattered, at));
    p.opaque = 1.0f - c.spec_trans;
    if (film) each_once = select3(p.thin, each_once, mix3(each_once, with_film.scattered, c.film));
    // glTF's boundary transmits what it does not reflect in its brightest channel: with the weight w, 1 - w
    // (slope F + raise) is w slope (1 - F) + 1 - w (slope + raise).
    const CurveRows refracted = rows_further(c, sets, scattered, OPENPBR_REFRACTED - OPENPBR_SCATTERED);
    const float refracts = facet_curve(scene, refracted, at);
    const Tint most = tint_of(max_component(c.specular), along_normal, p.fades);
    const float slope = p.weight * most.slope, raise = p.weight * most.raise;
    const float rest = raise * p.plain + max_f(1.0f - slope - raise, 0.0f) * refracts;
    each_once =
        select3(gltf & !p.thin & !p.inside, add(scale(each_once, slope), uniform_vec3(rest)), each_once);
    p.glass = make_vec3(c.spec_trans / max_f(each_once.x, 1e-3f), c.spec_trans / max_f(each_once.y, 1e-3f),
                        c.spec_trans / max_f(each_once.z, 1e-3f));
    p.transmits = p.inside ? 1.0f : p.dielectric * c.spec_trans;
    const vec3 shown =
        select3(passes_the_rest(c, p), uniform_vec3(max_component(from_dielectric)), p.reflected);
    const vec3 passed = scale(sub(white, shown), p.dielectric * c.spec_trans);
    const float passed_on_average = film ? luminance(passed) : passed.x;
    diffuse = sub(diffuse, scale(returned, p.dielectric * c.spec_trans));
    // What comes back from walks counts with what is scattered to the other side of a wall.
    const vec3 scattered_on = scale(passed_below(p, p.sub_passed), p.dielectric * p.opaque);
    const vec3 comes_back = mul(scattered_on, select3(walks, c.subsurface, white));

    p.coat_facets = openpbr_microfacets(c.clearcoat_gloss, 0.0f);
    const CurveRows coat_rows = facet_rows(c, sets, OPENPBR_COAT, facet_place(p.coat_facets.alpha_u));
    const CurveRows fuzz_rows =
        facet_rows(c, sets, OPENPBR_FUZZ, facet_place(sqr(max_f(c.sheen_tint, LEAST_FUZZ_ROUGHNESS))));
    if (HAS(COAT_NORMALS)) {
      p.coat_normal = select3((c.variant & OPENPBR_OWN_COAT) != 0, c.coat_normal, p.coat_normal);
      p.coat_wo = to_frame(p.coat_normal, wo);
      p.open_coat = has_open_coat(c) & !p.inside;
    }
    p.coat = (p.inside | !(p.coat_wo.z > 0.0f)) ? 0.0f : c.clearcoat;
    const float coat_reflects = facet_curve(scene, coat_rows, curve_place(p.coat_wo.z));
    const CurveRows narrow_rows = rows_further(c, sets, fuzz_rows, OPENPBR_FUZZ_NARROW - OPENPBR_FUZZ),
                    lean_rows = rows_further(c, sets, fuzz_rows, OPENPBR_FUZZ_LEAN - OPENPBR_FUZZ);
    p.fuzz_ltc = fuzz_ltc(facet_curve(scene, narrow_rows, at), facet_curve(scene, lean_rows, at));
    const float fuzz_reflects = p.fuzz_reflects = facet_curve(scene, fuzz_rows, at);
    // Of fuzz that reflects more than arrives the lobe is dimmed.
    p.fuzz = p.inside ? 0.0f : c.sheen / max_f(fuzz_reflects, 1.0f);
    const float of_colour = gltf ? max_component(c.k) : 1.0f;
    p.above_coat = max_f(1.0f - p.fuzz * fuzz_reflects * of_colour, 0.0f);
    // Of the light from below the coat reflects `back`, again and again: all that comes up from a diffuse
    // base, as much as on the way in from a mirror.
    const vec3 albedo = add(add(add(at_once, diffuse), passed), comes_back);
    const float ior2 = max_f(c.clearcoat_rate * c.clearcoat_rate, 1.0f);
    const float from_all_sides = 1.0f - (1.0f - between_rows(scene, coat_rows, CURVE_KNOTS)) / ior2;
    const float spread =
        luminance(diffuse) + luminance(at_once) * c.roughness + (walks ? luminance(comes_back) : 0.0f);
    const float back =
        mix_f(coat_reflects, from_all_sides, min_f(spread * inverse_or_0(luminance(albedo)), 1.0f));
    const vec3 darkened =
        make_vec3(left_after(back, albedo.x), left_after(back, albedo.y), left_after(back, albedo.z));
    p.below = scale(mix3(white, darkened, p.coat * c.diffuse_rate),
                    p.above_coat * max_f(1.0f - p.coat * coat_reflects, 0.0f));
    p.below = select3(p.inside, white, p.below);
    const float left = luminance(p.below);
    p.share_coat = p.above_coat * p.coat * coat_reflects;
    p.share_fuzz = p.fuzz * fuzz_reflects * luminance(c.k);
    facets = p.inside ? 1.0f : left * (facets + passed_on_average);
    diffuse = scale(diffuse, p.inside ? 0.0f : left);
    p.share_sub = max_f(luminance(comes_back) * left, 0.0f);
  }
  const float scattered_diffusely = max_f(luminance(diffuse), 0.0f);
  const float to_unit =
      inverse_or_0(scattered_diffusely + facets + p.share_coat + p.share_fuzz + p.share_sub);
  p.share_diffuse = scattered_diffusely * to_unit;
  p.share_facets = facets * to_unit;
  p.share_coat *= to_unit;
  p.share_fuzz *= to_unit;
  p.share_sub *= to_unit;
  return p;
}

/// f cos of all that is not reflected by the microfacets at once; `lambert` is wi.z / pi.
FN vec3 openpbr_diffuse(const PRIVATE Scene* scene, Closure c, OpenPbr p, bool layered, vec3 wo, vec3 wi,
                        float lambert) {
  const CurveRows rows = layered ? base_rows(c, p.facets, true, wi) : p.rows;
  const float plain = base_albedos(scene, rows, curve_place(wi.z)).plain;
  const float metal =
      p.metal * lambert * (1.0f - p.plain) * (1.0f - plain) / max_f(1.0f - p.mean_plain, 1e-6f);
  const float dielectric = p.dielectric * p.opaque * lambert;
  vec3 diffuse = p.base_colour;
  if (layered) {
    const RoughDiffuse d = rough_diffuse(c.flatness, wo, wi);
    diffuse = make_vec3(rough_diffuse_value(d, diffuse.x), rough_diffuse_value(d, diffuse.y),
                        rough_diffuse_value(d, diffuse.z));
    diffuse = add(scale(diffuse, p.inside ? 1.0f : 1.0f - c.diff_trans), p.sub_reflected);
  }
  return add_scaled(scale(below_dielectric(p, diffuse), dielectric), metal, p.metal_again);
}

FN BsdfValue openpbr_value(const PRIVATE Scene* scene, Closure c, OpenPbr p, vec3 wo, vec3 wi) {
  const MicrofacetReflection facets = microfacet_reflection(p.facets, wo, wi);
  const vec3 fresnel = uniform_vec3(dielectric_fresnel(facets.cosine, c.ior).reflectance);
  const vec3 metal = metal_fresnel(p.metal_base, p.dip, facets.cosine);
  const float lambert = INV_PI_F * wi.z;
  const vec3 reflected = add_scaled(scale(tinted(p, fresnel, 1.0f), p.dielectric), p.metal, metal);
  BsdfValue value;
  value.f_cos = add_scaled(openpbr_diffuse(scene, c, p, false, wo, wi, lambert), facets.f_cos, reflected);
  value.pdf = p.share_diffuse * lambert + p.share_facets * facets.pdf;
  return select_bsdf_value((wi.z > 0.0f) & (wo.z > 0.0f), value, no_bsdf_value());
}

/// `film`: as for openpbr_of. `into`: only of what goes into the medium inside, which is part of no other
/// value.
FN BsdfValue openpbr_layered_value(const PRIVATE Scene* scene, Closure c, OpenPbr p, bool film, vec3 wo,
                                   vec3 wi, bool into) {
  // A thin wall mirrors what it lets through.
  const bool through = wi.z < 0.0f, refracts = through & !p.thin;
  const vec3 above = make_vec3(wi.x, wi.y, FABS(wi.z)), towards = select3(p.thin, above, wi);
  const vec3 sum = add_scaled(wo, refracts ? c.ior : 1.0f, towards);
  const float length2 = dot3(sum, sum), to_unit = 1.0f / SQRT(max_f(length2, 1e-30f));
  const vec3 h = scale(sum, sum.z < 0.0f ? -to_unit : to_unit);
  const float cos_o = dot3(wo, h), cos_i = dot3(towards, h);
  const bool there = (wo.z > 0.0f) & (length2 > 0.0f) & (wi.z != 0.0f);
  const bool faces = there & !into & (cos_o > 0.0f) & (refracts ? cos_i < 0.0f : cos_i > 0.0f);

  // The base's microfacets.
  const vec3 fresnel =
      base_reflectances(scene, c, p, film, FABS(cos_o), dielectric_fresnel(FABS(cos_o), c.ior).reflectance);
  const vec3 glass_reflects = select3(p.thin, reflectances_of_two(fresnel), fresnel);
  const vec3 tinted_glass = tinted(p, glass_reflects, 1.0f);
  const vec3 glass_passes =
      sub(uniform_vec3(1.0f),
          select3(passes_the_rest(c, p), uniform_vec3(max_component(tinted_glass)), glass_reflects));
  const float density = reflected_density(p.facets, wo, h);
  const float masked = density * microfacet_masking(p.facets, above);
  const float jacobian = 4.0f * cos_o * FABS(cos_i) * (to_unit * to_unit);
  const vec3 metal = metal_reflectances(scene, c, p, film, FABS(cos_o));
  const vec3 by_glass = mul(tinted_glass, p.glass);
  const vec3 by_both = add_scaled(by_glass, p.opaque, tinted(p, fresnel, 1.0f));
  const vec3 outside = add_scaled(scale(by_both, p.dielectric), p.metal, metal);
  const vec3 in_glass = scale(p.glass, p.dielectric);
  const vec3 reflected = select3(p.inside, mul(in_glass, fresnel), outside);
  const vec3 once = make_vec3(SQRT(c.transmitted.x), SQRT(c.transmitted.y), SQRT(c.transmitted.z));
  const vec3 passed =
      mul(select3(p.thin, c.transmitted, once), scale(mul(in_glass, glass_passes), p.thin ? 1.0f : jacobian));
  const float share_passed = p.transmits * (1.0f - chance_of_reflection(c, p, film, glass_reflects));
  const float facets_pdf =
      density * (through ? share_passed * (p.thin ? 1.0f : c.ior * c.ior * jacobian) : 1.0f - share_passed);
  vec3 f_cos = scale(select3(through, passed, reflected), faces ? masked : 0.0f);
  float pdf = faces ? p.share_facets * facets_pdf : 0.0f;

  // Diffuse, and what is on top.
  const bool outer = there & !through & !p.inside;
  const float lambert = outer ? INV_PI_F * wi.z : 0.0f;
  f_cos = add(f_cos, openpbr_diffuse(scene, c, p, true, wo, above, lambert));
  const float behind = (there & through & (p.thin | into)) ? INV_PI_F * above.z : 0.0f;
  f_cos = add_scaled(f_cos, p.dielectric * p.opaque * behind, passed_below(p, p.sub_passed));
  // The coat absorbs by the lengths of the ways through it, of which coat_colour has two along the normal.
  // What goes into the medium is absorbed on the way out as if it came back with the cosine of its way in.
  const float coat_o = max_f(p.coat_wo.z, 0.0f), coat_i = max_f(dot3(p.coat_normal, above), 0.0f);
  const float way_o = 1.0f / max_f(dielectric_fresnel(coat_o, c.clearcoat_rate).cosine, 1e-3f);
  const float way_i = 1.0f / max_f(dielectric_fresnel(coat_i, c.clearcoat_rate).cosine, 1e-3f);
  const vec3 absorbed = transmittance_power3(c.eta, 0.5f * (way_o + ((through & !into) ? 0.0f : way_i)));
  f_cos = mul(f_cos, mul(p.below, mix3(uniform_vec3(1.0f), absorbed, p.coat)));

  const vec3 coat_wi = HAS(COAT_NORMALS) ? to_frame(p.coat_normal, wi) : above;
  const bool coated = there & (p.coat > 0.0f) & (coat_wi.z > 0.0f) & (p.open_coat | !through);
  const MicrofacetReflection coat = microfacet_reflection(p.coat_facets, p.coat_wo, coat_wi);
  const float coat_fresnel = dielectric_fresnel(max_f(coat.cosine, 0.0f), c.clearcoat_rate).reflectance;
  const float on_top = coated ? p.above_coat * p.coat * coat_fresnel * coat.f_cos : 0.0f;
  const vec3 half_way = add(wo, above);
  const float cos_h = half_way.z / SQRT(max_f(dot3(half_way, half_way), 1e-30f));
  const bool gltf = (c.variant & OPENPBR_GLTF) != 0;
  const float of_gltf = fuzz_lobe(c.sheen_tint, wo.z, above.z, min_f(cos_h, 1.0f)) * wi.z;
  const float of_lobe = fuzz_pdf(p.fuzz_ltc, wo, above), fuzz_density = gltf ? 0.5f * INV_PI_F : of_lobe;
  const float fuzz = outer ? p.fuzz * (gltf ? of_gltf : p.fuzz_reflects * of_lobe) : 0.0f;
  f_cos = add_scaled(add(f_cos, uniform_vec3(on_top)), fuzz, c.k);
  pdf += p.share_sub * behind;
  const float coat_pdf = coated ? p.share_coat * coat.pdf : 0.0f;
  pdf += p.share_diffuse * lambert + (coat_pdf + (outer ? p.share_fuzz * fuzz_density : 0.0f));
  BsdfValue value;
  value.f_cos = f_cos;
  value.pdf = pdf;
  return select_bsdf_value(there, value, no_bsdf_value());
}

FN BsdfValue openpbr_eval(const PRIVATE Scene* scene, Closure c, vec3 wo, vec3 wi) {
  return openpbr_value(scene, c, openpbr_of(scene, c, false, false, wo), wo, wi);
}

FN BsdfSample openpbr_sample(const PRIVATE Scene* scene, Closure c, vec3 wo, float u, float v, float choice) {
  const OpenPbr p = openpbr_of(scene, c, false, false, wo);
  const vec3 mirrored = mirror_about(wo, sample_microfacet(p.facets, wo, u, v));
  const vec3 wi = select3(choice < p.share_facets, mirrored, cosine_hemisphere(u, v));
  return sample_of_value(wi, openpbr_value(scene, c, p, wo, wi));
}

FN BsdfValue openpbr_layered_eval(const PRIVATE Scene* scene, Closure c, vec3 wo, vec3 wi) {
  return openpbr_layered_value(scene, c, openpbr_of(scene, c, true, false, wo), false, wo, wi, false);
}
FN BsdfValue openpbr_film_eval(const PRIVATE Scene* scene, Closure c, vec3 wo, vec3 wi) {
  return openpbr_layered_value(scene, c, openpbr_of(scene, c, true, true, wo), true, wo, wi, false);
}

FN BsdfSample sample_openpbr_layers(const PRIVATE Scene* scene, Closure c, bool film, vec3 wo, float u,
                                    float v, float choice) {
  const OpenPbr p = openpbr_of(scene, c, true, film, wo);
  const float up_to_fuzz = p.share_diffuse + p.share_fuzz, up_to_coat = up_to_fuzz + p.share_coat;
  const bool is_diffuse = choice < p.share_diffuse, is_fuzz = !is_diffuse & (choice < up_to_fuzz);
  const bool is_coat = !is_diffuse & !is_fuzz & (choice < up_to_coat);
  const bool is_sub =
      !is_diffuse & !is_fuzz & !is_coat & (p.share_sub > 0.0f) & (choice >= 1.0f - p.share_sub);
  const bool is_base = !is_diffuse & !is_fuzz & !is_coat & !is_sub;
  Microfacets chosen = p.facets;
  chosen.alpha_u = is_coat ? p.coat_facets.alpha_u : p.facets.alpha_u;
  chosen.alpha_v = is_coat ? p.coat_facets.alpha_v : p.facets.alpha_v;
  // The coat's facets are in its own frame.
  const vec3 seen = select3(is_coat, p.coat_wo, wo), facet = sample_microfacet(chosen, seen, u, v);
  const float cosine = max_f(dot3(seen, facet), 0.0f);
  const DielectricFresnel boundary = dielectric_fresnel(cosine, c.ior);
  const vec3 reflectances = base_reflectances(scene, c, p, film, cosine, boundary.reflectance);
  const float reflects =
      chance_of_reflection(c, p, film, select3(p.thin, reflectances_of_two(reflectances), reflectances));
  const bool transmits = is_base & (choice < up_to_coat + p.share_facets * (p.transmits * (1.0f - reflects)));
  vec3 mirrored = mirror_about(seen, facet);
  const bool leaves_coat = !is_coat | (mirrored.z > 0.0f);
  if (HAS(COAT_NORMALS))
    mirrored = select3(is_coat, from_frame(p.coat_normal, mirrored.x, mirrored.y, mirrored.z), mirrored);
  const vec3 passed = select3(p.thin, make_vec3(mirrored.x, mirrored.y, -mirrored.z),
                              refract_about(wo, facet, cosine, boundary.cosine, c.ior));
  const vec3 evenly = cosine_hemisphere(u, v);
  const vec3 to_fuzz =
      select3((c.variant & OPENPBR_GLTF) != 0, sample_uniform_hemisphere(make_vec3(0.0f, 0.0f, 1.0f), u, v),
              sample_fuzz(p.fuzz_ltc, wo, evenly));
  const vec3 scattered = select3(is_diffuse, evenly, to_fuzz);
  BsdfSample s = no_bsdf_sample();
  s.wi = select3(is_diffuse | is_fuzz, scattered, select3(transmits, passed, mirrored));
  s.wi = select3(is_sub, make_vec3(evenly.x, evenly.y, -evenly.z), s.wi);
  s.eta = (transmits & !p.thin) ? c.ior : 1.0f;
  const bool into = is_sub & !p.thin;
  const BsdfValue value = openpbr_layered_value(scene, c, p, film, wo, s.wi, into);
  // A facet may scatter to the wrong side of the surface.
  const bool right_side = (transmits | is_sub) == (s.wi.z < 0.0f);
  s.pdf = ((right_side | (is_coat & p.open_coat)) & leaves_coat) ? value.pdf : 0.0f;
  s.weight = scale(value.f_cos, s.pdf > 0.0f ? 1.0f / s.pdf : 0.0f);
  s.pdf = (into & (s.pdf > 0.0f)) ? DELTA_PDF : s.pdf;
  return s;
}

FN BsdfSample openpbr_layered_sample(const PRIVATE Scene* scene, Closure c, vec3 wo, float u, float v,
                                     float choice) {
  return sample_openpbr_layers(scene, c, false, wo, u, v, choice);
}
FN BsdfSample openpbr_film_sample(const PRIVATE Scene* scene, Closure c, vec3 wo, float u, float v,
                                  float choice) {
  return sample_openpbr_layers(scene, c, true, wo, u, v, choice);
}

FN ControlLobes openpbr_control(const PRIVATE Scene* scene, Closure c, float cosine) {
  const OpenPbr p =
      openpbr_of(scene, c, false, false, make_vec3(safe_sqrt(1.0f - cosine * cosine), 0.0f, cosine));
  const MicrofacetLobe lobe = microfacet_lobe(scene, DISTRIBUTION_GGX, p.facets.alpha_u, cosine);
  const float at = fresnel_cosine(lobe), fresnel = dielectric_fresnel(at, c.ior).reflectance;
  const vec3 reflected = add_scaled(scale(tinted(p, uniform_vec3(fresnel), 1.0f), p.dielectric), p.metal,
                                    metal_fresnel(p.metal_base, p.dip, at));
  // What is below the dielectric as a Lambert lobe.
  const vec3 below = below_dielectric(p, p.base_colour);
  return make_control_lobes(add_scaled(scale(below, p.dielectric), p.metal * (1.0f - p.plain), p.metal_again),
                            lobe, reflected);
}

PENUMBRA_NAMESPACE_END
#endif
