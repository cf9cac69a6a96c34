// Tests whether a rendered image equals a reference within the noise of both: a z-test for each block of
// pixels.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace penumbra::statistics {

/// Interleaved channels: value c of pixel (x, y) is values[(y * width + x) * channels + c].
struct Image {
  int width = 0, height = 0, channels = 0;
  std::vector<double> values;

  Image() = default;
  Image(int w, int h, int c) : width(w), height(h), channels(c), values(std::size_t(w) * h * c) {}

  [[nodiscard]] std::size_t index(int x, int y, int c) const {
    return (std::size_t(y) * width + x) * channels + c;
  }
  [[nodiscard]] double at(int x, int y, int c) const { return values[index(x, y, c)]; }
  double& at(int x, int y, int c) { return values[index(x, y, c)]; }
};

/// Mean over all pixels of a channel.
double channel_mean(const Image& image, int channel);

/// Means of `block` x `block` pixels; width and height must be multiples of `block` (std::invalid_argument).
Image block_average(const Image& image, int block);

/// An image with the standard error of each of its values.
struct Estimate {
  Image mean;
  Image standard_error;
  /// How well the standard errors are known: from R batches, R - 1; infinity if they count as exact.
  double dof = 0;
};

/// The mean of independent renders of equal sample count (other seeds) and the standard error from their
/// spread. At least two, of one shape (std::invalid_argument).
Estimate estimate_from_batches(std::span<const Image> batches);

struct ImageTestLimits {
  double significance = 0.01;         ///< chance that any value of a correct image passes the limit
  double accepted_fraction = 0.9975;  ///< of the values that must be inside the limit
  double mean_square = 1.1;           ///< upper bound on the mean of z^2 ...
  double set_aside = 0;               ///< ... of all values but this share, of those with the largest
};

struct ImageTestResult {
  std::size_t count = 0;  ///< values compared: pixels times channels
  double limit = 0;       ///< |z| allowed, two-sided, Sidak-corrected for `count`
  double accepted_fraction = 0;
  /// Of z, without what is set aside; about 1 where both standard errors are right, less where some is set
  /// aside.
  double mean_square = 0;
  double worst = 0;                                 ///< z farthest from 0 ...
  int worst_x = 0, worst_y = 0, worst_channel = 0;  ///< ... and where
  bool passed = false;

  [[nodiscard]] std::string summary() const;
};

/// z = (a - b) / sqrt(SE_a^2 + SE_b^2) for each value. Where the standard errors come from few batches the
/// quotient follows Student's distribution, with the degrees of freedom of Welch and Satterthwaite; it is
/// turned into the normal deviate of the same probability, so that limit and mean square mean the same for
/// any number of batches. Equal values without error have z = 0, unequal ones an infinite z, NaNs likewise.
/// Shapes must agree (std::invalid_argument). The test of mitsuba3's test_renders.py with a reference whose
/// error is known, on blocks.
ImageTestResult z_test(const Estimate& a, const Estimate& b, const ImageTestLimits& limits = {});

}  // namespace penumbra::statistics
