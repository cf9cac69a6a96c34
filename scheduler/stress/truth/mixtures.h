// Reference BSDFs in 113-bit arithmetic: a lobe, possibly with a diffuse base, in the frame of the normal
// (the z axis).
#pragma once

#include "scheduler/stress/truth/quad.h"

namespace penumbra::stress {

/// The normalised Phong lobe: diffuse / pi + specular (e + 2) / (2 pi) cos^e, times the cosine of wi; and the
/// density, where a lobe is chosen in proportion to its reflectance. Directions need not be unit vectors.
struct PhongValue {
  Quad f_cos, pdf;
};
PhongValue phong(Quad diffuse, Quad specular, Quad exponent, const Quad3& n, const Quad3& wo,
                 const Quad3& wi);

/// The fraction of light from a direction at `angle` to the normal that a lobe of reflectance 1 reflects
/// above the horizon. It is computed by quadrature; the azimuth around the mirror direction is integrated in
/// closed form.
Quad phong_albedo(Quad exponent, Quad angle);

/// The same for light along the horizon: Gamma((e + 1) / 2) / (2 sqrt(pi) Gamma(e / 2 + 1)).
Quad phong_albedo_at_horizon(Quad exponent);

struct MixtureValue {
  Quad f_cos = 0, pdf = 0;
};

/// Directions need not be unit vectors. wo is above the horizon; wi is too, unless light is transmitted.
struct MixtureDirections {
  Quad3 wo, wi;
};

/// Ward's lobe; `variant` is one of the kernels' WARD_*.
MixtureValue ward_mixture(int variant, Quad diffuse, Quad specular, Quad alpha_u, Quad alpha_v,
                          const MixtureDirections& directions);

/// The Blinn-Phong lobe.
MixtureValue blinnphong_mixture(Quad diffuse, Quad specular, Quad exponent,
                                const MixtureDirections& directions);

/// The diffuse base of plastic under a smooth boundary.
MixtureValue plastic_base(Quad diffuse, Quad specular, Quad ior, Quad internal,
                          const MixtureDirections& directions);

/// The reflectance of a conductor with refractive index eta and absorption k (Born and Wolf 1999, section
/// 14.2).
Quad conductor_fresnel(Quad cosine, Quad eta, Quad k);

/// A dielectric boundary: its reflectance, and the cosine of the transmitted direction, 0 for total
/// reflection (Fresnel's amplitudes and Snell's law).
struct BoundaryFresnel {
  Quad reflectance, cosine;
};
BoundaryFresnel boundary_fresnel(Quad cosine, Quad ior);

/// A conductor with GGX microfacets (Walter et al. 2007, Heitz 2014; the density is that of visible normals).
MixtureValue ggx_conductor(Quad specular, Quad eta, Quad k, Quad alpha_u, Quad alpha_v,
                           const MixtureDirections& directions);

/// A dielectric boundary with GGX microfacets, in either direction (Walter et al. 2007, equations 20 and 21,
/// without the factor ior^2 of transmitted radiance).
MixtureValue ggx_dielectric(Quad specular, Quad ior, Quad alpha_u, Quad alpha_v,
                            const MixtureDirections& directions);

}  // namespace penumbra::stress
