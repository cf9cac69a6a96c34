// Smooth and rough conductors: Fresnel reflection without transmission.
#pragma once

#include "scenes/bsdfs/material.h"
#include "scenes/bsdfs/microfacet.h"
#include "scenes/plugin_values.h"
#include "scenes/refractive_indices.h"

namespace penumbra {

/// The refractive indices of a conductor.
struct ConductorSurface {
  int material = kMirror;  ///< see conductor_names
  TexturedColour eta{glm::vec3(0.0f)};
  TexturedColour k{glm::vec3(1.0f)};
  float ext_eta = 1.0f;  ///< refractive index outside
  TexturedColour specular_reflectance{glm::vec3(1.0f)};

  template <typename Row>
  static void parameters(const Row& row) {
    row("material", &ConductorSurface::material, conductor_names(), "measured material: eta and k");
    row("eta", &ConductorSurface::eta, IndexColour{}, "refractive index, instead of a material");
    row("k", &ConductorSurface::k, IndexColour{}, "absorption, likewise");
    row("ext_eta", &ConductorSurface::ext_eta, RefractiveIndex{}, "refractive index outside");
    row("specular_reflectance", &ConductorSurface::specular_reflectance, ColourWithin{},
        "factor of the reflection");
  }

  /// In files before version 2 the default material is copper.
  void written_for(std::int64_t major_version) {
    if (major_version < 2) set_material(*conductor_names().parse("Cu"));
  }

  template <typename Given>
  void complete(Findings& findings, const Given& given) {
    if (given("eta") != given("k"))
      findings.push_back({given("eta") ? "eta" : "k", "a conductor needs both, eta and k"});
    else if (given("eta") && given("material"))
      findings.push_back({"material", "a conductor has either a material, or eta and k"});
    else if (!given("eta"))
      set_material(material);
    if (ext_eta != 1.0f && (eta.texture != kNoTexture || k.texture != kNoTexture))
      findings.push_back({"ext_eta", "must be 1 where eta or k is a texture"});
  }

  /// A material of that family with the fields that all conductors have.
  [[nodiscard]] Material material_with(int family) const {
    Material m = material_of_family(family);
    PENUMBRA_SET_FIELD(m, specular, specular_reflectance);
    PENUMBRA_SET_FIELD(m, eta, eta);
    PENUMBRA_SET_FIELD(m, k, k);
    m.eta = scale(m.eta, 1.0f / ext_eta);
    m.k = scale(m.k, 1.0f / ext_eta);
    return m;
  }

 private:
  void set_material(int conductor) {
    const ComplexIndex index = conductor_index(conductor);
    material = conductor;
    eta = index.eta;
    k = index.k;
  }
};

struct ConductorBsdf : ConductorSurface {
  static constexpr const char* kPlugin = "conductor";
  static constexpr const char* kText = "smooth metal";
};

struct RoughConductorBsdf : ConductorSurface, RoughSurface {
  static constexpr const char* kPlugin = "roughconductor";
  static constexpr const char* kText = "rough metal (microfacets)";

  template <typename Row>
  static void parameters(const Row& row) {
    ConductorSurface::parameters(row);
    RoughSurface::parameters(row);
  }
  template <typename Given>
  void complete(Findings& findings, const Given& given) {
    ConductorSurface::complete(findings, given);
    RoughSurface::complete(findings, given);
  }
};

inline Material material_of(const ConductorBsdf& conductor) {
  return conductor.material_with(FAMILY_CONDUCTOR);
}

inline Material material_of(const RoughConductorBsdf& conductor) {
  Material m =
      conductor.material_with(conductor.family(FAMILY_ROUGHCONDUCTOR_GGX, FAMILY_ROUGHCONDUCTOR_BECKMANN));
  conductor.set_roughness(m);
  return m;
}

}  // namespace penumbra
