// Directional albedos of GGX microfacets, for the curves of the metallic-roughness BSDF. They are computed
// when the program is built: see write_reflection_albedo.cpp.
#pragma once

#include <vector>

namespace penumbra {

/// Directional albedos of isotropic GGX microfacets with Smith's separable masking, after a single
/// reflection.
struct MicrofacetAlbedo {
  double plain = 1;    ///< if they reflect all light
  double schlick = 0;  ///< if they reflect (1 - cos)^5 of it, with the cosine at the half vector
};

/// The albedos for roughness alpha in (0, 1] and a cosine of wo in (0, 1], to 0.001.
MicrofacetAlbedo microfacet_albedo(double alpha, double cosine);

/// The curves that reflection_albedo (kernels/bsdf/metalrough.h) interpolates.
std::vector<float> reflection_albedo_curves();

}  // namespace penumbra
