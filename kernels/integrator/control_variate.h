// The factor alpha of a control variate, from a pixel's own samples. Sample i has, in one colour channel, H_i
// (the mean of w V over its shadow rays), W_i (the same of w, without shadows) and the closed form G_i, all
// >= 0, with H_i <= W_i and E[C_i] = 0 for C_i = W_i - G_i whatever the camera ray. Its estimate is
//   e_i = (H_i - alpha W_i) + alpha G_i = H_i - alpha C_i,
// whose variance is least at alpha* = E[H C] / E[C^2]. NaNs and infinities are zeroed beforehand in all
// three.
#ifndef PENUMBRA_CONTROL_VARIATE_H
#define PENUMBRA_CONTROL_VARIATE_H
#include "kernels/math/math.h"

PENUMBRA_NAMESPACE_BEGIN

#define CONTROL_PRIOR_SAMPLES 4.0f    // what the guess weighs against the regression
#define CONTROL_NOISE_FLOOR 1e-6f     // of C^2 / G^2: nearer than this W and G are equal
#define CONTROL_SHORTFALL_NOISE 6.0f  // squared standard errors that W may fall short of G by chance
#define CONTROL_FULLY_LIT 0.99999f    // H / W from which on nothing is taken to be shadowed
#define CONTROL_LEAST_SQUARES 1e-12f  // against division by 0; scaled samples have a thousand times as much

/// The power of two that brings x >= 0, and with it all that is not larger, to below 4 without rounding (to
/// [1, 2) unless x is within a factor of two of the largest float, or subnormal).
FN float power_of_two_scale(float x) {
  int exponent = (int)(FLOAT_BITS(x) >> 23);
  exponent = exponent < 1 ? 1 : (exponent > 253 ? 253 : exponent);  // an inverse that is normal
  return BITS_FLOAT((uint)(254 - exponent) << 23);
}

/// Alpha for those of a pixel's `count` samples, each `stride` after the last, whose absolute index has
/// parity `wanted`; `parity` is that of the first one's absolute index. It depends on the samples of the
/// other parity alone, which are independent of those that it is applied to, so the estimate has no bias
/// whatever the rule. 0 where there are none: nothing is known then, and 0 costs no variance. The rule is a
/// regression with a guess for a prior:
///
/// - The guess is the ratio v = sum H / sum W: exactly 1 where all is lit, 0 in the umbra, near alpha* in
///   between, and of little variance.
/// - The regression of H - v W on C, sum (H - v W) C / sum C^2, is added to it. In the limit that is alpha*,
///   which may be far outside [0, 1]. (H - v W rather than H: what varies with the camera ray alone is out of
///   it, and it leaves an exact guess alone.) It is multiplied by (m - 1) / (m - 1 + 4) for m samples, since
///   they leave m - 1 degrees of freedom and a regression on two samples is worse than none; 3 or 8 in the
///   place of 4 change little. Choosing among 0, v and the regression by cross-validation, weighing them by
///   it, and shrinking by the regression's standard error have been tried: worse for m <= 4, and no better
///   above.
/// - Samples that all miss a highlight have W far below G and would take the visibility of the dim rest for
///   that of the highlight, which costs dozens of times the error of alpha = 0 where the highlight is hidden.
///   So a share of D, what sum W falls short of sum G, is put back as one more sample of C = W: (D / sum G)^2
///   of it, or 1 - 6 sum C^2 / D^2 where that is more, both next to nothing if D is the usual noise. It
///   counts as dark if anything was seen to be shadowed, else as lit: a hidden highlight that nothing hints
///   at costs the noise of the unshadowed light.
/// - Where w is constant, as for projected solid angle and a diffuse surface, C is rounding: the floor under
///   sum C^2 keeps it from being blown up. Where C / G is .003 that takes a tenth off the regression.
FN float cross_fitted_alpha(const GLOBAL float* RESTRICT h, const GLOBAL float* RESTRICT w,
                            const GLOBAL float* RESTRICT g, int stride, int count, int parity, int wanted) {
  const int begin = (parity == wanted ? stride : 0), end = count * stride, next = 2 * stride;
  float largest = 0.0f;
  for (int i = begin; i < end; i += next) largest = max_f(largest, max_f(w[i], g[i]));
  const float scaling = power_of_two_scale(largest);
  float shadowed = 0.0f, unshadowed = 0.0f, analytic = 0.0f, squares = 0.0f, floor_squares = 0.0f, m = 0.0f;
  for (int i = begin; i < end; i += next) {
    const float scaled_w = w[i] * scaling, scaled_g = g[i] * scaling;
    shadowed += h[i] * scaling;
    unshadowed += scaled_w;
    analytic += scaled_g;
    squares += sqr(scaled_w - scaled_g);
    floor_squares += sqr(scaled_g);
    m += scaled_w + scaled_g > 0.0f ? 1.0f : 0.0f;  // camera rays that meet no light tell nothing
  }
  if (!(unshadowed > 0.0f)) return 0.0f;
  const float shortfall = max_f(analytic - unshadowed, 0.0f);
  const float by_chance = CONTROL_SHORTFALL_NOISE * squares, square = sqr(shortfall);
  const float beyond_chance = by_chance < square ? 1.0f - by_chance / square : 0.0f;
  const float missed = shortfall > 0.0f ? shortfall * max_f(sqr(shortfall / analytic), beyond_chance) : 0.0f;
  const float missed_lit = shadowed >= CONTROL_FULLY_LIT * unshadowed ? missed : 0.0f;
  const float guess = (shadowed + missed_lit) / (unshadowed + missed);
  float products = (missed_lit - guess * missed) * missed;
  for (int i = begin; i < end; i += next)
    products += (h[i] * scaling - guess * (w[i] * scaling)) * (w[i] * scaling - g[i] * scaling);
  const float all_squares = squares + sqr(missed) + CONTROL_NOISE_FLOOR * floor_squares;
  const float trust = (m - 1.0f) / (m - 1.0f + CONTROL_PRIOR_SAMPLES);
  return guess + trust * (products / max_f(all_squares, CONTROL_LEAST_SQUARES));
}

PENUMBRA_NAMESPACE_END
#endif
