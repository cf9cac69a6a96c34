// A diffuse base under a smooth dielectric boundary, including interreflection between the two (Mitsuba 0.6
// and 3).
#pragma once

#include <fmt/format.h>

#include "kernels/bsdf/microfacet.h"
#include "scenes/bsdfs/material.h"
#include "scenes/bsdfs/material_tables.h"
#include "scenes/bsdfs/rough_boundary.h"
#include "scenes/plugin_values.h"
#include "scenes/refractive_indices.h"

namespace penumbra {

/// Reports refractive indices for which the model is not valid.
inline void check_boundary(float int_ior, float ext_ior, Findings& findings) {
  const float ratio = int_ior / ext_ior;
  if (!(ratio <= kMostIndexRatio && ratio >= 1 / kMostIndexRatio))
    findings.push_back(
        {"int_ior", fmt::format("int_ior and ext_ior may differ by a factor of {} at most, not {} to {}",
                                kMostIndexRatio, int_ior, ext_ior)});
}

/// The rows of every plastic.
template <typename Plastic, typename Row>
void boundary_rows(const Row& row) {
  row("diffuse_reflectance", &Plastic::diffuse, ColourWithin{}, "albedo of the base");
  row("specular_reflectance", &Plastic::specular, ColourWithin{}, "factor of what the boundary reflects");
  row("int_ior", &Plastic::int_ior, RefractiveIndex{}, "refractive index beneath the boundary");
  row("ext_ior", &Plastic::ext_ior, RefractiveIndex{}, "refractive index above it");
}

/// The rows of plastics in which light goes to and fro.
template <typename Plastic, typename Row>
void coating_rows(const Row& row) {
  row("nonlinear", &Plastic::nonlinear, TrueOrFalse{},
      "the base's colour deepens each time that light is reflected back to it");
  row("optical_depth", &Plastic::optical_depth, NumberWithin{LowEnd::kClosed, 0.0f, 1e6f},
      "of the coating along its normal: what it absorbs");
}

/// The rows of plastics with a rough boundary.
template <typename Plastic, typename Row>
void microfacet_rows(const Row& row) {
  row("distribution", &Plastic::distribution,
      OneOf<int>{{{"beckmann", DISTRIBUTION_BECKMANN}, {"ggx", DISTRIBUTION_GGX}}},
      "of the boundary's microfacets");
  row("alpha", &Plastic::alpha, NumberWithin{LowEnd::kClosed, 0.0f, MOST_ALPHA}, "their roughness");
  row("sample_visible", &Plastic::sample_visible, TrueOrFalse{},
      "read and ignored: visible microfacets are sampled");
}

struct PlasticBsdf {
  static constexpr const char* kPlugin = "plastic";
  static constexpr const char* kText = "diffuse base under a smooth dielectric coating";
  TexturedColour diffuse{glm::vec3(0.5f)};
  TexturedColour specular{glm::vec3(1.0f)};
  float int_ior = 1.49f;
  float ext_ior = 1.000277f;
  bool nonlinear = false;
  float optical_depth = 0.0f;

  template <typename Row>
  static void parameters(const Row& row) {
    boundary_rows<PlasticBsdf>(row);
    coating_rows<PlasticBsdf>(row);
  }
  void complete(Findings& findings) const { check_boundary(int_ior, ext_ior, findings); }
};

inline Material material_of(const PlasticBsdf& plastic) {
  Material m = material_of_family(FAMILY_PLASTIC);
  PENUMBRA_SET_FIELD(m, diffuse, plastic.diffuse);
  PENUMBRA_SET_FIELD(m, specular, plastic.specular);
  m.variant = plastic.nonlinear ? PLASTIC_NONLINEAR : PLASTIC_LINEAR;
  m.ior = plastic.int_ior / plastic.ext_ior;
  m.diffuse_rate = plastic.optical_depth;
  m.internal = float(smooth_internal_reflectance(double(m.ior), double(plastic.optical_depth)));
  return m;
}

struct RoughPlasticBsdf {
  static constexpr const char* kPlugin = "roughplastic";
  static constexpr const char* kText = "diffuse base under a rough dielectric coating";
  TexturedColour diffuse{glm::vec3(0.5f)};
  TexturedColour specular{glm::vec3(1.0f)};
  float int_ior = 1.49f;
  float ext_ior = 1.000277f;
  bool nonlinear = false;
  int distribution = DISTRIBUTION_BECKMANN;
  TexturedNumber alpha{0.1f};
  bool sample_visible = true;  ///< accepted; visible normals are always sampled
  float optical_depth = 0.0f;

  template <typename Row>
  static void parameters(const Row& row) {
    boundary_rows<RoughPlasticBsdf>(row);
    coating_rows<RoughPlasticBsdf>(row);
    microfacet_rows<RoughPlasticBsdf>(row);
  }
  void complete(Findings& findings) const {
    check_boundary(int_ior, ext_ior, findings);
    if (int_ior == ext_ior)
      findings.push_back({"int_ior",
                          "int_ior and ext_ior must differ: between equal refractive indices there is no "
                          "boundary (a diffuse bsdf has none)"});
  }
};

/// Mitsuba 3's pplastic without polarisation: the specular lobe of rough plastic, and a base that light
/// enters and leaves once, as through a smooth boundary (Baek et al. 2018, "Simultaneous acquisition of
/// polarimetric SVBRDF and normals").
struct PolarizedPlasticBsdf {
  static constexpr const char* kPlugin = "pplastic";
  static constexpr const char* kText = "rough plastic of Baek et al. 2018, without polarisation";
  TexturedColour diffuse{glm::vec3(0.5f)};
  TexturedColour specular{glm::vec3(1.0f)};
  float int_ior = 1.49f;
  float ext_ior = 1.000277f;
  int distribution = DISTRIBUTION_BECKMANN;
  TexturedNumber alpha{0.1f};
  bool sample_visible = true;  ///< accepted; visible normals are always sampled

  template <typename Row>
  static void parameters(const Row& row) {
    boundary_rows<PolarizedPlasticBsdf>(row);
    microfacet_rows<PolarizedPlasticBsdf>(row);
  }
  void complete(Findings& findings) const {
    RoughPlasticBsdf{.int_ior = int_ior, .ext_ior = ext_ior}.complete(findings);
  }
};

inline Material material_of(const RoughPlasticBsdf& plastic, MaterialTables& tables,
                            bool smooth_base = false) {
  const bool ggx = plastic.distribution == DISTRIBUTION_GGX;
  Material m = material_of_family(ggx ? FAMILY_ROUGHPLASTIC_GGX : FAMILY_ROUGHPLASTIC_BECKMANN);
  PENUMBRA_SET_FIELD(m, diffuse, plastic.diffuse);
  PENUMBRA_SET_FIELD(m, specular, plastic.specular);
  m.variant = plastic.nonlinear ? PLASTIC_NONLINEAR : PLASTIC_LINEAR;
  m.ior = plastic.int_ior / plastic.ext_ior;
  PENUMBRA_SET_FIELD(m, alpha_u, plastic.alpha);
  m.alpha_u = m.alpha_v = clamp_f(m.alpha_u, LEAST_ALPHA, MOST_ALPHA);
  m.curve_rows = plastic.alpha.texture == kNoTexture ? 1 : CURVE_ROWS;
  m.curve = tables.boundary(
      {plastic.distribution, double(m.alpha_u), double(m.ior), smooth_base, double(plastic.optical_depth)},
      m.curve_rows);
  return m;
}

inline Material material_of(const PolarizedPlasticBsdf& plastic, MaterialTables& tables) {
  RoughPlasticBsdf rough{
      .int_ior = plastic.int_ior, .ext_ior = plastic.ext_ior, .distribution = plastic.distribution};
  rough.diffuse = plastic.diffuse;
  rough.specular = plastic.specular;
  rough.alpha = plastic.alpha;
  return material_of(rough, tables, true);
}

}  // namespace penumbra
