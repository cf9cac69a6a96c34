// Formats the comparison as a table.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "scheduler/image/compare.h"

namespace penumbra {
namespace {

constexpr double kPercent = 100;

std::string row(const std::string& name, const ChannelValues& values, const std::string& note = "") {
  std::string text = fmt::format("{:<14} {:>12.6g}", name, values.overall);
  // With a single channel there is nothing more to show.
  if (values.channels.size() > 1) {
    for (const double value : values.channels) text += fmt::format(" {:>12.6g}", value);
  }
  if (!note.empty()) text += "   " + note;
  return text + "\n";
}

std::string heading(const ImagePair& pair) {
  std::string text = fmt::format("{:<14} {:>12}", "", pair.channels.size() > 1 ? "all" : pair.channels[0]);
  if (pair.channels.size() > 1) {
    for (const std::string& channel : pair.channels) text += fmt::format(" {:>12}", channel);
  }
  return text + "\n";
}

ChannelValues ratios(const Comparison& c) {
  ChannelValues values;
  values.overall = c.image_mean.overall / c.reference_mean.overall;
  for (std::size_t channel = 0; channel < c.pair.channels.size(); ++channel)
    values.channels.push_back(c.mean_ratio(channel));
  return values;
}

std::string flip_text(const Comparison& c) {
  if (!c.flip) return fmt::format("{:<14} {:>12}   left out: {}\n", "FLIP", "-", c.flip_left_out);
  const FlipResult& flip = *c.flip;
  std::string text = fmt::format(
      "{:<14} {:>12.6g}   0 to 1; at most {:.4g}, at pixel {},{}; {:.4g} pixels per degree",
      flip.hdr ? "HDR-FLIP" : "LDR-FLIP", flip.mean, flip.largest, flip.x, flip.y, flip.pixels_per_degree);
  if (flip.hdr) {
    text += fmt::format("; {} exposures from {:+.2f} to {:+.2f} stops", flip.exposures.count,
                        flip.exposures.start, flip.exposures.stop);
  }
  return text + "\n";
}

std::string z_line(const char* name, const ZExtreme& extreme, const std::string& where) {
  return fmt::format("  {:<26} {:>11.4g}   {}; p = {:.3g}\n", name, extreme.z, where, extreme.p);
}

/// Where the variances of an image come from.
std::string source_of(const std::vector<float>& variance, const std::optional<SampleCounts>& samples) {
  if (variance.empty()) return "none, counts as exact";
  if (!samples) return "exact";
  return samples->least == samples->most
             ? fmt::format("estimated from {:g} samples per pixel", samples->mean)
             : fmt::format("estimated from {:g} to {:g} samples per pixel", samples->least, samples->most);
}

std::string z_text(const Comparison& c) {
  if (!c.z_test) return fmt::format("{:<14} {:>12}   left out: {}\n", "z-test", "-", c.z_test_left_out);
  const ZTest& z = *c.z_test;
  const auto& names = c.pair.channels;
  const auto at = [&](const ZExtreme& e) {
    return fmt::format("{} at pixel {},{}", names[e.channel], e.x, e.y);
  };
  const bool less = z.image_samples || z.reference_samples;
  std::string text = fmt::format(
      "z-test of {} values: z = d / sqrt(Var), at significance {}\n"
      "  variances: of A {}; of B {}\n"
      "  |z| above 1.96, 2.58       {:>10.3f} % {:.3f} %   expected: {}5 %, 0.99 %\n"
      "  mean of z^2                {:>11.4g}   expected: {}1\n",
      z.values, z.options.significance, source_of(c.image_variance, z.image_samples),
      source_of(c.reference_variance, z.reference_samples), kPercent * z.share_above_1_96,
      kPercent * z.share_above_2_58, less ? "at most " : "", z.mean_square, less ? "at most " : "");
  const std::string blocks =
      fmt::format("of {} blocks of {} x {} pixels and channels", z.blocks, z.options.block, z.options.block);
  text += z_line("largest z", z.largest, at(z.largest));
  text += z_line("least likely chi^2 of z^2", z.block_chi_square,
                 fmt::format("of {:.0f}, {}, {}", z.block_chi_square.dof, at(z.block_chi_square), blocks));
  text += z_line("largest z of a block mean", z.block_mean, fmt::format("{}, {}", at(z.block_mean), blocks));
  text += z_line("z of the image mean", z.image_mean, names[z.image_mean.channel]);
  text += fmt::format(
      "  p: corrected for the number of values (Bonferroni); below {:.4g} it is a difference\n", z.limit());
  if (z.exact_different > 0) {
    text += fmt::format("  {} values have no variance on either side and yet differ\n", z.exact_different);
  }
  if (z.exact_equal > 0)
    text += fmt::format("  {} values have no variance and are equal: left out\n", z.exact_equal);
  if (z.invalid_variances > 0) {
    text += fmt::format("  {} values have a variance that is negative or not finite\n", z.invalid_variances);
  }
  if (z.unknown_variances > 0) {
    text += fmt::format("  {} values are in blocks of fewer than {} samples: left out\n", z.unknown_variances,
                        kLeastBlockSamples);
  }
  return text;
}

std::string verdict_text(const Comparison& c) {
  constexpr const char* kTexts[] = {"the images agree within their noise", "THE IMAGES DIFFER",
                                    "inconclusive"};
  return fmt::format("verdict: {}{}: {}\n", kTexts[int(c.verdict)],
                     c.z_test && c.verdict != Verdict::kInconclusive
                         ? fmt::format(", at significance {}", c.z_test->options.significance)
                         : "",
                     c.verdict_reason);
}

}  // namespace

std::string comparison_text(const Comparison& c) {
  const ImagePair& pair = c.pair;
  const PixelWindow& w = pair.window;
  const bool halves = !pair.second_reference.empty();
  std::string text = fmt::format(
      "{} x {} pixels{}, layer {}, d = A - B, B is {}\n", w.width, w.height,
      w.x != 0 || w.y != 0 ? fmt::format(" from {},{}", w.x, w.y) : "", c.layer,
      halves ? "the mean of two references, d^2 = (A - B1)(A - B2): free of their noise" : "the reference");
  if (pair.image_non_finite + pair.reference_non_finite > 0) {
    text +=
        fmt::format("left out, as NaN or infinite: {} pixels of A, {} of B; {} of {} compared\n",
                    pair.image_non_finite, pair.reference_non_finite, pair.compared_pixels, pair.pixels());
  }
  text += heading(pair);
  text += row("mean of A", c.image_mean);
  text += row("mean of B", c.reference_mean);
  text += row("A / B", ratios(c), "of the means");
  text += row("bias", c.bias, "mean of d");
  text += row("relative bias", c.relative_bias, "mean of d / mean of B");
  text += row("MSE", c.mse, "mean of d^2");
  text += row("relMSE", c.relative_mse, fmt::format("mean of d^2 / (B^2 + {})", c.epsilon));
  text += row("relMSE trimmed", c.trimmed_relative_mse,
              fmt::format("without the {} pixels of the largest terms ({:.3g} %, rounded down)",
                          c.trimmed_pixels, kPercent * kTrimmedShare));
  text += row("relMSE of blocks", c.block_relative_mse,
              fmt::format("of the means of {0} x {0} pixels", kErrorBlock));
  text += row("MAPE", c.mape, fmt::format("mean of |d| / (|B| + {})", c.epsilon));
  text += row("SMAPE", c.smape, fmt::format("mean of |d| / (|A| + |B| + {})", c.epsilon));
  text += row("PSNR", c.psnr, "dB: 10 log10(largest B^2 / MSE)");
  text += row(
      "max |d|", c.largest,
      fmt::format("{} at pixel {},{}", pair.channels[c.largest_at.channel], c.largest_at.x, c.largest_at.y));
  return text + flip_text(c) + z_text(c) + verdict_text(c);
}

}  // namespace penumbra
