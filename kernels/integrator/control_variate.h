// The factor alpha of a control variate, estimated from a pixel's own samples. In one colour channel, sample
// i has H_i (the mean of w V over its shadow rays), W_i (the mean of w, without shadows) and the closed form
// G_i. All are >= 0, H_i <= W_i, and E[C_i] = 0 for C_i = W_i - G_i for any camera ray. The estimate
//   e_i = (H_i - alpha W_i) + alpha G_i = H_i - alpha C_i
// has the least variance at alpha* = E[H C] / E[C^2]. NaNs and infinities in all three are replaced by 0
// beforehand.
#ifndef PENUMBRA_CONTROL_VARIATE_H
#define PENUMBRA_CONTROL_VARIATE_H
#include "kernels/math/math.h"

PENUMBRA_NAMESPACE_BEGIN

#define CONTROL_PRIOR_SAMPLES 4.0f    // weight of the guess against the regression
#define CONTROL_NOISE_FLOOR 1e-6f     // of C^2 / G^2: below it W and G are taken as equal
#define CONTROL_SHORTFALL_NOISE 6.0f  // squared standard errors by which W may be below G by chance
#define CONTROL_FULLY_LIT 0.99999f    // of H / W: above it nothing is taken as shadowed
#define CONTROL_LEAST_SQUARES 1e-12f  // avoids division by 0; scaled samples have a thousand times as much

/// The power of two that scales x >= 0, and so all numbers up to x, to below 4 without rounding (x itself to
/// [1, 2), unless it is subnormal or within a factor of two of the largest float).
FN float power_of_two_scale(float x) {
  int exponent = (int)(FLOAT_BITS(x) >> 23);
  exponent = exponent < 1 ? 1 : (exponent > 253 ? 253 : exponent);  // so that the inverse is a normal number
  return BITS_FLOAT((uint)(254 - exponent) << 23);
}

/// Alpha for those of a pixel's `count` samples whose absolute index has parity `wanted`. Samples are
/// `stride` apart; `parity` is that of the first one's absolute index. Alpha depends only on the samples of
/// the other parity. They are independent of those that it is applied to, so the estimate is unbiased for any
/// rule. Without such samples alpha is 0: nothing is known then, and 0 adds no variance. The rule is a
/// regression with a guess as its prior:
///
/// - The guess is the ratio v = sum H / sum W: exactly 1 where all is lit, 0 in the umbra, near alpha* in
/// between. Its variance is low.
/// - The regression of H - v W on C, sum (H - v W) C / sum C^2, is added to it. The sum converges to alpha*,
/// which may be far outside [0, 1]. (H - v W instead of H removes what varies with the camera ray only, and
/// leaves an exact guess unchanged.) The regression is multiplied by (m - 1) / (m - 1 + 4) for m samples,
/// since they leave m - 1 degrees of freedom and a regression on two samples is worse than none; 3 or 8
/// instead of 4 change little. Tried, and worse for m <= 4 and no better above: choosing among 0, v and the
/// regression by cross-validation, weighting them by it, and shrinking by the regression's standard error.
/// - Samples that all miss a highlight have W far below G. They would take the visibility of the dim rest for
/// that of the highlight, which costs dozens of times the error of alpha = 0 if the highlight is shadowed. So
/// with D = sum G - sum W, a fraction of D is added as one more sample of C = W: the fraction is (D / sum
/// G)^2, or 1 - 6 sum C^2 / D^2 if that is larger. Both are almost 0 if D is ordinary noise. The added sample
/// is taken as shadowed if any shadow was seen, else as lit: an occluded highlight of which no sample shows a
/// shadow costs the noise of the unshadowed light.
/// - Where w is constant, as with projected solid angle sampling of a diffuse surface, C is rounding error.
/// The floor under sum C^2 keeps it from being amplified. Where C / G is .003, the floor takes a tenth off
/// the regression.
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
    m += scaled_w + scaled_g > 0.0f ? 1.0f : 0.0f;  // samples without any light from polygons say nothing
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
