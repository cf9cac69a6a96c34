#include "scheduler/image/metrics/error_metrics.h"

#include <algorithm>
#include <cmath>

#include "scheduler/image/metrics/compensated_sum.h"

namespace penumbra {
namespace {

/// The mean of term(i) over the finite pixels, where i is the index of a value.
template <typename Term>
ChannelValues mean_of(const ImagePair& pair, Term term) {
  const std::size_t channels = pair.channels.size();
  std::vector<CompensatedSum> sums(channels);
  for (std::size_t pixel = 0; pixel < pair.pixels(); ++pixel) {
    if (!pair.finite[pixel]) continue;
    for (std::size_t c = 0; c < channels; ++c) sums[c].add(term(pixel * channels + c));
  }
  ChannelValues result;
  CompensatedSum all;
  for (const CompensatedSum& sum : sums) {
    result.channels.push_back(sum.value() / double(pair.compared_pixels));
    all.add(sum.value());
  }
  result.overall = all.value() / (double(pair.compared_pixels) * double(channels));
  return result;
}

/// 0 / 0 counts as no error.
double ratio(double error, double scale) { return error == 0 ? 0 : error / scale; }

double relative_square(const ImagePair& pair, std::size_t i, double epsilon) {
  const double truth = pair.truth(i);
  return ratio(pair.squared_difference(i), truth * truth + epsilon);
}

/// The mean of all terms except the `left_out` largest. The sum is in the order of pixels.
double trimmed_mean(const std::vector<double>& terms, std::size_t left_out) {
  const std::size_t kept = terms.size() - left_out;
  double largest_kept = INFINITY;
  if (left_out > 0) {
    std::vector<double> order = terms;
    std::ranges::nth_element(order, order.begin() + std::ptrdiff_t(kept - 1));
    largest_kept = order[kept - 1];
  }
  CompensatedSum sum;
  std::size_t below = 0;
  for (const double term : terms) {
    if (left_out > 0 && !(term < largest_kept)) continue;
    sum.add(term);
    ++below;
  }
  if (below < kept) sum.add(double(kept - below) * largest_kept);
  return sum.value() / double(kept);
}

}  // namespace

ChannelValues image_mean(const ImagePair& pair) {
  return mean_of(pair, [&](std::size_t i) { return pair.value(i); });
}

ChannelValues reference_mean(const ImagePair& pair) {
  return mean_of(pair, [&](std::size_t i) { return pair.truth(i); });
}

ChannelValues bias(const ImagePair& pair) {
  return mean_of(pair, [&](std::size_t i) { return pair.difference(i); });
}

ChannelValues relative_bias(const ImagePair& pair) {
  ChannelValues result = bias(pair);
  const ChannelValues reference = reference_mean(pair);
  for (std::size_t c = 0; c < pair.channels.size(); ++c) result.channels[c] /= reference.channels[c];
  result.overall /= reference.overall;
  return result;
}

ChannelValues mean_squared_error(const ImagePair& pair) {
  return mean_of(pair, [&](std::size_t i) { return pair.squared_difference(i); });
}

ChannelValues relative_mse(const ImagePair& pair, double epsilon) {
  return mean_of(pair, [&](std::size_t i) { return relative_square(pair, i, epsilon); });
}

ChannelValues block_relative_mse(const ImagePair& pair, double epsilon) {
  return relative_mse(block_means(pair, kErrorBlock), epsilon);
}

std::uint64_t trimmed_pixels(const ImagePair& pair, double share) {
  return std::uint64_t(share * double(pair.compared_pixels));
}

ChannelValues trimmed_relative_mse(const ImagePair& pair, double epsilon, double share) {
  const std::size_t channels = pair.channels.size(), left_out = trimmed_pixels(pair, share);
  std::vector<std::vector<double>> terms(channels + 1);  // the last one: means over channels
  for (auto& list : terms) list.reserve(pair.compared_pixels);
  for (std::size_t pixel = 0; pixel < pair.pixels(); ++pixel) {
    if (!pair.finite[pixel]) continue;
    double sum = 0;
    for (std::size_t c = 0; c < channels; ++c) {
      const double term = relative_square(pair, pixel * channels + c, epsilon);
      terms[c].push_back(term);
      sum += term;
    }
    terms[channels].push_back(sum / double(channels));
  }
  ChannelValues result;
  for (std::size_t c = 0; c < channels; ++c) result.channels.push_back(trimmed_mean(terms[c], left_out));
  result.overall = trimmed_mean(terms[channels], left_out);
  return result;
}

ChannelValues mean_absolute_percentage_error(const ImagePair& pair, double epsilon) {
  return mean_of(pair, [&](std::size_t i) {
    return ratio(std::abs(pair.difference(i)), std::abs(pair.truth(i)) + epsilon);
  });
}

ChannelValues symmetric_mean_absolute_percentage_error(const ImagePair& pair, double epsilon) {
  return mean_of(pair, [&](std::size_t i) {
    return ratio(std::abs(pair.difference(i)), std::abs(pair.value(i)) + std::abs(pair.truth(i)) + epsilon);
  });
}

ChannelValues peak_signal_to_noise_ratio(const ImagePair& pair) {
  const std::size_t channels = pair.channels.size();
  std::vector<double> peaks(channels);
  for (std::size_t i = 0; i < pair.image.size(); ++i) {
    if (pair.finite[i / channels])
      peaks[i % channels] = std::max(peaks[i % channels], std::abs(pair.truth(i)));
  }
  const auto decibel = [](double peak, double mse) { return 20 * std::log10(peak) - 10 * std::log10(mse); };
  ChannelValues result = mean_squared_error(pair);
  for (std::size_t c = 0; c < channels; ++c) result.channels[c] = decibel(peaks[c], result.channels[c]);
  result.overall = decibel(std::ranges::max(peaks), result.overall);
  return result;
}

LargestDifference largest_difference(const ImagePair& pair) {
  LargestDifference largest{.value = -1};
  const std::size_t channels = pair.channels.size();
  for (std::size_t i = 0; i < pair.image.size(); ++i) {
    const std::size_t pixel = i / channels;
    if (!pair.finite[pixel] || !(std::abs(pair.difference(i)) > largest.value)) continue;
    const auto width = std::size_t(pair.window.width);
    largest = {std::abs(pair.difference(i)), pair.window.x + int(pixel % width),
               pair.window.y + int(pixel / width), i % channels};
  }
  return largest;
}

ChannelValues largest_differences(const ImagePair& pair) {
  const std::size_t channels = pair.channels.size();
  ChannelValues result{.channels = std::vector<double>(channels)};
  for (std::size_t i = 0; i < pair.image.size(); ++i) {
    if (!pair.finite[i / channels]) continue;
    double& largest = result.channels[i % channels];
    largest = std::max(largest, std::abs(pair.difference(i)));
  }
  result.overall = std::ranges::max(result.channels);
  return result;
}

}  // namespace penumbra
