#include "tests/support/image_test.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <stdexcept>
#include <vector>

#include "tests/support/statistics.h"

namespace penumbra::statistics {
namespace {

void require_same_shape(const Image& a, const Image& b) {
  if (a.width != b.width || a.height != b.height || a.channels != b.channels) {
    throw std::invalid_argument(fmt::format("images differ in shape: {}x{}x{} and {}x{}x{}", a.width,
                                            a.height, a.channels, b.width, b.height, b.channels));
  }
}

/// Degrees of freedom of the sum of two independent squared standard errors (Welch-Satterthwaite).
double pooled_dof(double squared_a, double dof_a, double squared_b, double dof_b) {
  const double spread = squared_a * squared_a / dof_a + squared_b * squared_b / dof_b;
  if (spread == 0) return std::numeric_limits<double>::infinity();
  return (squared_a + squared_b) * (squared_a + squared_b) / spread;
}

double deviate(double difference, double squared_a, double dof_a, double squared_b, double dof_b) {
  if (difference == 0) return 0;
  const double t = difference / std::sqrt(squared_a + squared_b);
  const double z = student_to_normal(t, pooled_dof(squared_a, dof_a, squared_b, dof_b));
  return std::isnan(z) ? std::numeric_limits<double>::infinity() : z;
}

}  // namespace

double channel_mean(const Image& image, int channel) {
  double sum = 0;
  for (std::size_t i = channel; i < image.values.size(); i += image.channels) sum += image.values[i];
  return sum / (double(image.width) * image.height);
}

Image block_average(const Image& image, int block) {
  if (block < 1 || image.width % block != 0 || image.height % block != 0) {
    throw std::invalid_argument(
        fmt::format("{}x{} pixels do not divide into blocks of {}", image.width, image.height, block));
  }
  Image result(image.width / block, image.height / block, image.channels);
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      for (int c = 0; c < image.channels; ++c) {
        result.at(x / block, y / block, c) += image.at(x, y, c) / (double(block) * block);
      }
    }
  }
  return result;
}

Estimate estimate_from_batches(std::span<const Image> batches) {
  if (batches.size() < 2) throw std::invalid_argument("a standard error needs at least two batches");
  Estimate estimate{.mean = batches[0], .standard_error = batches[0], .dof = double(batches.size()) - 1};
  for (const Image& batch : batches) require_same_shape(batches[0], batch);
  for (std::size_t i = 0; i < estimate.mean.values.size(); ++i) {
    Sample sample;
    for (const Image& batch : batches) sample.add(batch.values[i]);
    estimate.mean.values[i] = sample.mean();
    estimate.standard_error.values[i] = sample.standard_error();
  }
  return estimate;
}

std::string ImageTestResult::summary() const {
  return fmt::format(
      "{}: {} values, {:.4f}% with |z| < {:.2f}, mean z^2 {:.3f}, worst z {:.2f} at ({}, {}) channel {}",
      passed ? "same" : "different", count, 100 * accepted_fraction, limit, mean_square, worst, worst_x,
      worst_y, worst_channel);
}

ImageTestResult z_test(const Estimate& a, const Estimate& b, const ImageTestLimits& limits) {
  require_same_shape(a.mean, b.mean);
  require_same_shape(a.mean, a.standard_error);
  require_same_shape(b.mean, b.standard_error);
  ImageTestResult result;
  result.count = a.mean.values.size();
  if (result.count == 0) throw std::invalid_argument("z_test: empty images");
  result.limit = sidak_limit(limits.significance, result.count);
  std::size_t accepted = 0;
  std::vector<double> squares;
  for (int y = 0; y < a.mean.height; ++y) {
    for (int x = 0; x < a.mean.width; ++x) {
      for (int c = 0; c < a.mean.channels; ++c) {
        const double error_a = a.standard_error.at(x, y, c), error_b = b.standard_error.at(x, y, c);
        const double z = deviate(a.mean.at(x, y, c) - b.mean.at(x, y, c), error_a * error_a, a.dof,
                                 error_b * error_b, b.dof);
        accepted += std::abs(z) < result.limit ? 1 : 0;
        squares.push_back(z * z);
        if (std::abs(z) > std::abs(result.worst)) {
          result.worst = z;
          result.worst_x = x, result.worst_y = y, result.worst_channel = c;
        }
      }
    }
  }
  result.accepted_fraction = double(accepted) / double(result.count);
  const auto kept = squares.begin() + std::ptrdiff_t(double(result.count) * (1 - limits.set_aside));
  std::ranges::nth_element(squares, kept == squares.end() ? squares.begin() : kept);
  result.mean_square = std::reduce(squares.begin(), kept) / double(kept - squares.begin());
  result.passed =
      result.accepted_fraction >= limits.accepted_fraction && result.mean_square < limits.mean_square;
  return result;
}

}  // namespace penumbra::statistics
