// The normalised Phong lobe in 113-bit arithmetic.
#pragma once

#include "scheduler/stress/truth/quad.h"

namespace penumbra::stress {

/// diffuse / pi + specular (e + 2) / (2 pi) cos^e, times the cosine of wi; and the density, where a lobe is
/// chosen in proportion to its reflectance. Directions need not be unit vectors.
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

}  // namespace penumbra::stress
