// BSDFs of a lobe beside a diffuse base, in 113 bits, about the z axis.
#pragma once

#include "scheduler/stress/truth/quad.h"

namespace penumbra::stress {

struct MixtureValue {
  Quad f_cos = 0, pdf = 0;
};

/// Directions need not be unit vectors; they are above the horizon.
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

}  // namespace penumbra::stress
