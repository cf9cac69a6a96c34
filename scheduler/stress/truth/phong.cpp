#include "scheduler/stress/truth/phong.h"

#include "scheduler/stress/truth/quadrature.h"

namespace penumbra::stress {

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
