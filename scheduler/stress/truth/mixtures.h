// BSDFs of a lobe, some beside a diffuse base, in 113 bits, about the z axis.
#pragma once

#include "scheduler/stress/truth/quad.h"

namespace penumbra::stress {

struct MixtureValue {
  Quad f_cos = 0, pdf = 0;
};

/// Directions need not be unit vectors. wo is above the horizon, wi too, or beneath it where light is
/// transmitted.
struct MixtureDirections {
  Quad3 wo, wi;
};

/// Ward's lobes: `variant` as WARD_* of the kernels.
MixtureValue ward_mixture(int variant, Quad diffuse, Quad specular, Quad alpha_u, Quad alpha_v,
                          const MixtureDirections& directions);

/// Blinn and Phong's.
MixtureValue blinnphong_mixture(Quad diffuse, Quad specular, Quad exponent,
                                const MixtureDirections& directions);

/// The diffuse base of plastic, whose boundary is a mirror.
MixtureValue plastic_base(Quad diffuse, Quad specular, Quad ior, Quad internal,
                          const MixtureDirections& directions);

/// A conductor's reflectance, of refractive index eta and absorption k (Born and Wolf 1999, section 14.2).
Quad conductor_fresnel(Quad cosine, Quad eta, Quad k);

/// A boundary between dielectrics: what it reflects, and the cosine beyond it, 0 if it reflects everything
/// (Fresnel's amplitudes and Snell's law).
struct BoundaryFresnel {
  Quad reflectance, cosine;
};
BoundaryFresnel boundary_fresnel(Quad cosine, Quad ior);

/// GGX microfacets of a conductor (Walter et al. 2007, Heitz 2014; visible normals for the density).
MixtureValue ggx_conductor(Quad specular, Quad eta, Quad k, Quad alpha_u, Quad alpha_v,
                           const MixtureDirections& directions);

/// GGX microfacets between dielectrics, either way (Walter et al. 2007, equations 20 and 21; radiance, so
/// without the factor ior^2 of what crosses).
MixtureValue ggx_dielectric(Quad specular, Quad ior, Quad alpha_u, Quad alpha_v,
                            const MixtureDirections& directions);

}  // namespace penumbra::stress
