// Whether two images agree within their noise, differ, or whether that cannot be told.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "scenes/integrators.h"
#include "scheduler/image/compare.h"

namespace penumbra {
namespace {

/// If only a larger difference of the images' means would be found, their agreement means nothing.
constexpr double kUsefulDifference = 0.1;

/// Why the layer `variance` of an image does not describe the noise of its blocks; empty: it does.
std::string why_not_independent(const std::string& name, const Image& image) {
  const std::string integrator = metadata_text(image, "penumbra:integrator");
  if (integrator == PhotonMapIntegrator::kName || integrator == ProgressivePhotonIntegrator::kName)
    return fmt::format("the pixels of {} share photons ({}), so variances of pixels do not tell its noise",
                       name, integrator);
  const std::string method = metadata_text(image, "penumbra:denoised_by");
  if (!method.empty())
    return fmt::format("{} is denoised ({}), so its variances do not tell its error", name, method);
  return "";
}

bool are_equal(const ImagePair& pair) {
  const auto differs = [&](std::size_t i) { return pair.value(i) != pair.truth(i); };
  for (std::size_t i = 0; i < pair.image.size(); ++i) {
    if (differs(i)) return false;
  }
  return true;
}

/// The tests that found a difference.
std::string differences(const Comparison& c) {
  const ZTest& z = *c.z_test;
  std::vector<std::string> found;
  const auto add = [&](const char* name, const char* statistic, const ZExtreme& e, bool everywhere) {
    if (!(e.p < z.limit())) return;
    const std::string where = everywhere ? "" : fmt::format(" at pixel {},{}", e.x, e.y);
    found.push_back(fmt::format("{} of {}{}: {} = {:.3g}, p = {:.2g}", name, c.pair.channels[e.channel],
                                where, statistic, e.z, e.p));
  };
  add("image mean", "z", z.image_mean, true);
  add("block mean", "z", z.block_mean, false);
  add("noise of a block", "chi^2", z.block_chi_square, false);
  add("single value", "z", z.largest, false);
  if (z.exact_different > 0) found.push_back(fmt::format("{} values without noise", z.exact_different));
  if (z.invalid_variances > 0)
    found.push_back(fmt::format("{} variances negative or not finite", z.invalid_variances));
  return fmt::format("{}", fmt::join(found, "; "));
}

}  // namespace

const char* verdict_name(Verdict verdict) {
  constexpr const char* kNames[] = {"agree", "differ", "inconclusive"};
  return kNames[int(verdict)];
}

void set_verdict(const CompareImages& images, const CompareOptions& options, Comparison& c) {
  const auto set = [&](Verdict verdict, std::string reason) {
    c.verdict = verdict;
    c.verdict_reason = std::move(reason);
  };
  if (are_equal(c.pair)) return set(Verdict::kAgree, "all values are equal");
  if (!c.z_test) return set(Verdict::kInconclusive, c.z_test_left_out);
  const ZTest& z = *c.z_test;
  std::string why;
  if (images.variance == nullptr) why = why_not_independent("A", images.image);
  if (why.empty() && images.reference_variance == nullptr) why = why_not_independent("B", images.reference);
  if (why.empty()) why = z.too_few_samples;
  if (!why.empty()) return set(Verdict::kInconclusive, why);
  if (!z.consistent) {
    if (c.reference_variance.empty() && !options.exact_reference)
      return set(Verdict::kInconclusive,
                 "B has no variances: they differ if B is without noise (--exact-reference)");
    if (c.image_variance.empty()) return set(Verdict::kInconclusive, "A has no variances (--variance)");
    return set(Verdict::kDiffer, differences(c));
  }
  if (z.values > 0 && !(z.visible_image_difference <= kUsefulDifference))
    return set(Verdict::kInconclusive,
               fmt::format("no difference found, but one below {:.3g} % of the image mean would not be seen",
                           100 * z.visible_image_difference));
  if (z.values == 0) return set(Verdict::kAgree, "no value has noise, and all are equal up to rounding");
  set(Verdict::kAgree,
      fmt::format("with 90 % probability, a difference of {:.2g} % of the image mean would be found, or of "
                  "{:.2g} % in a block of {} x {} pixels (median)",
                  100 * z.visible_image_difference, 100 * z.visible_block_difference, z.options.block,
                  z.options.block));
}

}  // namespace penumbra
