#include "scheduler/stress/truth/mixtures.h"

#include "kernels/bsdf/families.h"

namespace penumbra::stress {
namespace {

/// The half vector's slopes and what samplers need of it.
struct HalfVector {
  Quad3 h;
  Quad cosine;  ///< to either direction
};
HalfVector half_vector(const MixtureDirections& d) {
  const Quad3 h = normalize(normalize(d.wo) + normalize(d.wi));
  return {h, dot(h, normalize(d.wo))};
}

MixtureValue mixed(Quad diffuse, Quad specular, Quad lobe, Quad lobe_pdf, Quad cosine) {
  const Quad share = specular / (diffuse + specular);
  return {(diffuse / kQuadPi + specular * lobe) * cosine, (1 - share) * cosine / kQuadPi + share * lobe_pdf};
}

Quad transmittance(Quad cosine, Quad ior) {
  const Quad beyond = sqrt_q(1 - (1 - cosine * cosine) / (ior * ior));
  const Quad s = (cosine - ior * beyond) / (cosine + ior * beyond);
  const Quad p = (ior * cosine - beyond) / (ior * cosine + beyond);
  return 1 - (s * s + p * p) / 2;
}

}  // namespace

MixtureValue ward_mixture(int variant, Quad diffuse, Quad specular, Quad alpha_u, Quad alpha_v,
                          const MixtureDirections& directions) {
  const HalfVector half = half_vector(directions);
  const Quad in = normalize(directions.wi).z, out = normalize(directions.wo).z;
  const Quad x = half.h.x / (half.h.z * alpha_u), y = half.h.y / (half.h.z * alpha_v);
  const Quad slopes = exp_q(-(x * x + y * y)) / (kQuadPi * alpha_u * alpha_v);
  const Quad z2 = half.h.z * half.h.z;
  const Quad lobe = variant == WARD_ORIGINAL ? slopes / (4 * sqrt_q(in * out))
                    : variant == WARD_DUER   ? slopes / (4 * in * out)
                                             : slopes / (4 * half.cosine * half.cosine * z2 * z2);
  return mixed(diffuse, specular, lobe, slopes / (4 * half.cosine * z2 * half.h.z), in);
}

MixtureValue blinnphong_mixture(Quad diffuse, Quad specular, Quad exponent,
                                const MixtureDirections& directions) {
  const HalfVector half = half_vector(directions);
  const Quad angle = angle_between(half.h, {0, 0, 1}), power = exp_q(exponent * log_q(cos_q(angle)));
  const Quad norm =
      (exponent + 2) * (exponent + 4) / (8 * kQuadPi * (exp_q(-exponent / 2 * log_q(2)) + exponent));
  return mixed(diffuse, specular, norm * power, (exponent + 1) / (8 * kQuadPi * half.cosine) * power,
               normalize(directions.wi).z);
}

MixtureValue plastic_base(Quad diffuse, Quad specular, Quad ior, Quad internal,
                          const MixtureDirections& directions) {
  const Quad cosine = normalize(directions.wi).z;
  const Quad out = transmittance(normalize(directions.wo).z, ior), in = transmittance(cosine, ior);
  const Quad boundary = (1 - out) * specular, share = boundary / (boundary + out * diffuse);
  return {diffuse / (ior * ior * (1 - internal)) * out * in * cosine / kQuadPi,
          (1 - share) * cosine / kQuadPi};
}

}  // namespace penumbra::stress
