// Dielectric coatings of other BSDFs (Mitsuba 0.6), read as blends with a mirror: what a coating reflects
// grows with the angle, which a blend's weight cannot.
#pragma once

#include <variant>

#include "scenes/bsdfs/microfacet.h"
#include "scenes/bsdfs/plastic.h"

namespace penumbra {

/// The share of diffuse light from above that a smooth boundary reflects: what goes in comes out again, but
/// for the cone that is refracted into.
inline double smooth_external_reflectance(double ior) {
  return 1 - ior * ior * (1 - smooth_internal_reflectance(ior));
}

struct CoatingParameters {
  static constexpr const char* kPlugin = "coating";
  static constexpr const char* kText =
      "holds one bsdf under a dielectric coating: a mirror in a blend, with the share that the coating "
      "reflects of light from all sides";
  float int_ior = 1.49f;
  float ext_ior = 1.000277f;
  TexturedColour specular{glm::vec3(1.0f)};

  template <typename Row>
  static void parameters(const Row& row) {
    row("int_ior", &CoatingParameters::int_ior, RefractiveIndex{}, "refractive index of the coating");
    row("ext_ior", &CoatingParameters::ext_ior, RefractiveIndex{}, "refractive index above it");
    row("specular_reflectance", &CoatingParameters::specular, ColourWithin{}, "factor of what it reflects");
  }
  template <typename Given>
  void complete(Findings& findings, const Given&) const {
    check_boundary(int_ior, ext_ior, findings);
  }
};

struct RoughCoatingParameters : CoatingParameters, RoughSurface {
  static constexpr const char* kPlugin = "roughcoating";

  template <typename Row>
  static void parameters(const Row& row) {
    CoatingParameters::parameters(row);
    RoughSurface::parameters(row);
  }
  template <typename Given>
  void complete(Findings& findings, const Given& given) {
    CoatingParameters::complete(findings, given);
    RoughSurface::complete(findings, given);
  }
};

using CoatingPlugins = std::variant<CoatingParameters, RoughCoatingParameters>;

}  // namespace penumbra
