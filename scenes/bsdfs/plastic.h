// A diffuse base under a smooth dielectric boundary, including interreflection between the two (Mitsuba 0.6
// and 3).
#pragma once

#include <fmt/format.h>

#include "scenes/bsdfs/material.h"
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

struct PlasticBsdf {
  static constexpr const char* kPlugin = "plastic";
  static constexpr const char* kText = "diffuse base under a smooth dielectric coating";
  TexturedColour diffuse{glm::vec3(0.5f)};
  TexturedColour specular{glm::vec3(1.0f)};
  float int_ior = 1.49f;
  float ext_ior = 1.000277f;
  bool nonlinear = false;

  template <typename Row>
  static void parameters(const Row& row) {
    row("diffuse_reflectance", &PlasticBsdf::diffuse, ColourWithin{}, "albedo of the base");
    row("specular_reflectance", &PlasticBsdf::specular, ColourWithin{},
        "factor of what the boundary reflects");
    row("int_ior", &PlasticBsdf::int_ior, RefractiveIndex{}, "refractive index beneath the boundary");
    row("ext_ior", &PlasticBsdf::ext_ior, RefractiveIndex{}, "refractive index above it");
    row("nonlinear", &PlasticBsdf::nonlinear, TrueOrFalse{},
        "the base's colour deepens each time that light is reflected back to it");
  }
  void complete(Findings& findings) const { check_boundary(int_ior, ext_ior, findings); }
};

inline Material material_of(const PlasticBsdf& plastic) {
  Material m = material_of_family(FAMILY_PLASTIC);
  PENUMBRA_SET_FIELD(m, diffuse, plastic.diffuse);
  PENUMBRA_SET_FIELD(m, specular, plastic.specular);
  m.variant = plastic.nonlinear ? PLASTIC_NONLINEAR : PLASTIC_LINEAR;
  m.ior = plastic.int_ior / plastic.ext_ior;
  m.internal = float(smooth_internal_reflectance(double(m.ior)));
  return m;
}

}  // namespace penumbra
