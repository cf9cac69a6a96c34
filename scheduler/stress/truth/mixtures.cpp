#include "scheduler/stress/truth/mixtures.h"

#include "kernels/bsdf/families.h"
#include "scheduler/stress/truth/quadrature.h"

namespace penumbra::stress {
namespace {

/// The slopes of the half vector, and terms used by sampling densities.
struct HalfVector {
  Quad3 h;
  Quad cosine;  ///< with either direction
};
HalfVector half_vector(const MixtureDirections& d) {
  const Quad3 h = normalize(normalize(d.wo) + normalize(d.wi));
  return {h, dot(h, normalize(d.wo))};
}

MixtureValue mixed(Quad diffuse, Quad specular, Quad lobe, Quad lobe_pdf, Quad cosine) {
  const Quad share = specular / (diffuse + specular);
  return {(diffuse / kQuadPi + specular * lobe) * cosine, (1 - share) * cosine / kQuadPi + share * lobe_pdf};
}

Quad transmittance(Quad cosine, Quad ior) { return 1 - boundary_fresnel(cosine, ior).reflectance; }

struct Ggx {
  Quad alpha_u, alpha_v;
  [[nodiscard]] Quad density(const Quad3& h) const {
    const Quad x = h.x / alpha_u, y = h.y / alpha_v, sum = x * x + y * y + h.z * h.z;
    return 1 / (kQuadPi * alpha_u * alpha_v * sum * sum);
  }
  [[nodiscard]] Quad masking(const Quad3& w) const {
    const Quad x = alpha_u * w.x, y = alpha_v * w.y, z = w.z < 0 ? -w.z : w.z;
    return 2 * z / (z + sqrt_q(z * z + x * x + y * y));
  }
};

}  // namespace

Quad conductor_fresnel(Quad cosine, Quad eta, Quad k) {
  const Quad c2 = cosine * cosine, s2 = 1 - c2, t = eta * eta - k * k - s2;
  const Quad sum = sqrt_q(t * t + 4 * eta * eta * k * k);  // a^2 + b^2
  const Quad a = sqrt_q((sum + t) / 2), across = sum + c2, twice = 2 * a * cosine;
  const Quad s = (across - twice) / (across + twice);
  const Quad along = c2 * sum + s2 * s2, likewise = twice * s2;
  return s * (1 + (along - likewise) / (along + likewise)) / 2;
}

BoundaryFresnel boundary_fresnel(Quad cosine, Quad ior) {
  const Quad beyond2 = 1 - (1 - cosine * cosine) / (ior * ior);
  if (beyond2 <= 0) return {1, 0};
  const Quad beyond = sqrt_q(beyond2);
  const Quad s = (cosine - ior * beyond) / (cosine + ior * beyond);
  const Quad p = (ior * cosine - beyond) / (ior * cosine + beyond);
  return {(s * s + p * p) / 2, beyond};
}

MixtureValue ggx_conductor(Quad specular, Quad eta, Quad k, Quad alpha_u, Quad alpha_v,
                           const MixtureDirections& directions) {
  const HalfVector half = half_vector(directions);
  const Quad3 wo = normalize(directions.wo), wi = normalize(directions.wi);
  const Ggx ggx{alpha_u, alpha_v};
  const Quad pdf = ggx.density(half.h) * ggx.masking(wo) / (4 * wo.z);
  return {specular * conductor_fresnel(half.cosine, eta, k) * pdf * ggx.masking(wi), pdf};
}

MixtureValue ggx_dielectric(Quad specular, Quad ior, Quad alpha_u, Quad alpha_v,
                            const MixtureDirections& directions) {
  const Quad3 wo = normalize(directions.wo), wi = normalize(directions.wi);
  const bool reflects = wi.z > 0;
  const Quad n = reflects ? Quad(1) : ior;
  const Quad3 sum = wo + n * wi;
  const Quad3 h = (sum.z < 0 ? Quad(-1) : Quad(1)) * normalize(sum);
  const Quad out = dot(wo, h), in = dot(wi, h), reflected = boundary_fresnel(out, ior).reflectance;
  if (out <= 0 || (!reflects && in >= 0)) return {};
  const Ggx ggx{alpha_u, alpha_v};
  // Converts the density of normals to a density per solid angle of wi.
  const Quad jacobian = reflects ? 1 / (4 * out) : n * n * -in / dot(sum, sum);
  const Quad pdf =
      (reflects ? reflected : 1 - reflected) * ggx.density(h) * ggx.masking(wo) * out / wo.z * jacobian;
  return {specular * pdf * ggx.masking(wi) / (n * n), pdf};
}

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

PhongValue phong(Quad diffuse, Quad specular, Quad exponent, const Quad3& n, const Quad3& wo,
                 const Quad3& wi) {
  const Quad3 normal = normalize(n), out = normalize(wo), in = normalize(wi);
  const Quad cosine = dot(normal, in);
  if (cosine <= 0 || dot(normal, out) <= 0) return {0, 0};
  const Quad angle = angle_between(2 * dot(normal, out) * normal - out, in);
  const Quad power = 2 * angle < kQuadPi ? exp_q(exponent * log_q(cos_q(angle))) : Quad(0);
  const Quad lambert = cosine / kQuadPi, lobe = specular / (diffuse + specular);
  return {diffuse * lambert + specular * (exponent + 2) / (2 * kQuadPi) * power * cosine,
          (1 - lobe) * lambert + lobe * (exponent + 1) / (2 * kQuadPi) * power};
}

Quad phong_albedo(Quad exponent, Quad angle) {
  const Quad ct = cos_q(angle), st = sin_q(angle), half_pi = kQuadPi / 2;
  const auto ring = [&](Quad a) {
    const Quad up = cos_q(a) * ct, swing = sin_q(a) * st;
    const Quad sine = sin_q(a), power = exp_q(exponent * log_q(max_q(cos_q(a), exp_q(-9000))));
    if (up >= swing) return 2 * kQuadPi * up * power * sine;
    const Quad root = sqrt_q((swing - up) * (swing + up));
    return 2 * (up * atan2_q(root, -up) + root) * power * sine;
  };
  // Bounds at the lobe's width, and where its rings reach the horizon.
  std::vector<Quad> bounds{0, half_pi, half_pi - angle};
  for (const int k : {1, 2, 4, 8, 16}) bounds.push_back(min_q(k / sqrt_q(exponent + 1), half_pi));
  return (exponent + 2) / (2 * kQuadPi) * tanh_sinh(ring, bounds);
}

Quad phong_albedo_at_horizon(Quad exponent) {
  return exp_q(lgamma_q((exponent + 1) / 2) - lgamma_q(exponent / 2 + 1)) / (2 * sqrt_q(kQuadPi));
}

}  // namespace penumbra::stress
