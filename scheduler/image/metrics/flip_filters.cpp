#include "scheduler/image/metrics/flip_filters.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "kernels/host/parallel.h"

namespace penumbra {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kFeatureWidth = 0.082;  // in degrees
constexpr int kFewRows = 64;             // not worth a thread
constexpr int kMostThreads = 16;

/// Samples f at -radius … radius.
template <typename Function>
Kernel sampled(int radius, Function f) {
  Kernel kernel;
  for (int i = -radius; i <= radius; ++i) kernel.weights.push_back(f(double(i)));
  return kernel;
}

double sum_of(const Kernel& kernel) {
  double sum = 0;
  for (const double weight : kernel.weights) sum += weight;
  return sum;
}

void normalise_signs(Kernel& kernel) {
  double positive = 0, negative = 0;
  for (const double weight : kernel.weights) (weight > 0 ? positive : negative) += weight;
  for (double& weight : kernel.weights) weight /= weight > 0 ? positive : -negative;
  kernel.sums_to_zero = true;
}

double feature_deviation(double pixels_per_degree) { return 0.5 * kFeatureWidth * pixels_per_degree; }

int feature_radius(double deviation) { return int(std::ceil(3 * deviation)); }

Kernel normalised_gaussian(double deviation) {
  Kernel kernel = sampled(feature_radius(deviation),
                          [&](double x) { return std::exp(-x * x / (2 * deviation * deviation)); });
  const double sum = sum_of(kernel);
  for (double& weight : kernel.weights) weight /= sum;
  return kernel;
}

Plane length_of(const Plane& x, const Plane& y) {
  Plane length(x.width, x.height);
  for (std::size_t i = 0; i < length.values.size(); ++i)
    length.values[i] = std::sqrt(x.values[i] * x.values[i] + y.values[i] * y.values[i]);
  return length;
}

Plane response(const Plane& light, const Kernel& derivative, const Kernel& smoothing) {
  return length_of(convolve(light, derivative, smoothing), convolve(light, smoothing, derivative));
}

const float* row_of(const Plane& plane, int y) {
  return plane.values.data() + std::size_t(y) * std::size_t(plane.width);
}
float* row_of(Plane& plane, int y) { return plane.values.data() + std::size_t(y) * std::size_t(plane.width); }

/// Adds the contribution of one kernel weight to a whole row.
void add_tap(const Kernel& kernel, std::size_t tap, const float* shifted, const float* middle, int width,
             float* out) {
  const float weight = float(kernel.weights[tap]);
  if (kernel.sums_to_zero) {
    for (int x = 0; x < width; ++x) out[x] += weight * (shifted[x] - middle[x]);
  } else {
    for (int x = 0; x < width; ++x) out[x] += weight * shifted[x];
  }
}

}  // namespace

void for_bands(int height, const std::function<void(int y0, int y1)>& body) {
  const int bands = std::clamp(height / kFewRows, 1, std::min(int(core_count()), kMostThreads));
  in_parallel(std::size_t(bands), std::size_t(bands),
              [&](std::size_t i) { body(height * int(i) / bands, height * int(i + 1) / bands); });
}

Plane convolve(const Plane& source, const Kernel& across, const Kernel& down) {
  const int width = source.width, height = source.height;
  Plane rows(width, height), result(width, height);
  const int radius = across.radius(), reach = down.radius();
  for_bands(height, [&](int y0, int y1) {
    std::vector<float> padded(std::size_t(width + 2 * radius));
    for (int y = y0; y < y1; ++y) {
      const float* in = row_of(source, y);
      for (int x = -radius; x < width + radius; ++x)
        padded[std::size_t(x + radius)] = in[std::clamp(x, 0, width - 1)];
      for (std::size_t tap = 0; tap < across.weights.size(); ++tap)
        add_tap(across, tap, padded.data() + tap, in, width, row_of(rows, y));
    }
  });
  for_bands(height, [&](int y0, int y1) {
    for (int y = y0; y < y1; ++y) {
      for (std::size_t tap = 0; tap < down.weights.size(); ++tap) {
        const int from = std::clamp(y + int(tap) - reach, 0, height - 1);
        add_tap(down, tap, row_of(rows, from), row_of(rows, y), width, row_of(result, y));
      }
    }
  });
  return result;
}

Plane filter_by_sensitivity(const Plane& source, const Sensitivity& s, double pixels_per_degree) {
  // The same radius for all three channels: three standard deviations of the widest Gaussian.
  const double widest = std::sqrt(kBlueYellowSensitivity.b1 / (2 * kPi * kPi));
  const int radius = int(std::ceil(3 * widest * pixels_per_degree));
  const auto gaussian = [&](double b) {
    return sampled(radius, [&](double pixels) {
      const double x = pixels / pixels_per_degree;
      return std::exp(-kPi * kPi * x * x / b);
    });
  };
  const Kernel first = gaussian(s.b1), second = gaussian(s.b2);
  // A Gaussian of the distance is the product of a horizontal and a vertical one; the amplitude is in the
  // first.
  const double c1 = s.a1 * std::sqrt(kPi / s.b1), c2 = s.a2 * std::sqrt(kPi / s.b2);
  const double sum1 = sum_of(first), sum2 = sum_of(second);
  const double total = c1 * sum1 * sum1 + c2 * sum2 * sum2;
  const auto scaled = [](Kernel kernel, double factor) {
    for (double& weight : kernel.weights) weight *= factor;
    return kernel;
  };
  Plane result = convolve(source, scaled(first, c1 / total), first);
  if (c2 != 0) {
    const Plane more = convolve(source, scaled(second, c2 / total), second);
    for (std::size_t i = 0; i < result.values.size(); ++i) result.values[i] += more.values[i];
  }
  return result;
}

Plane edge_response(const Plane& light, double pixels_per_degree) {
  const double deviation = feature_deviation(pixels_per_degree);
  Kernel slope = sampled(feature_radius(deviation),
                         [&](double x) { return -x * std::exp(-x * x / (2 * deviation * deviation)); });
  normalise_signs(slope);
  return response(light, slope, normalised_gaussian(deviation));
}

Plane point_response(const Plane& light, double pixels_per_degree) {
  const double deviation = feature_deviation(pixels_per_degree);
  Kernel curvature = sampled(feature_radius(deviation), [&](double x) {
    const double square = x * x / (deviation * deviation);
    return (square - 1) * std::exp(-0.5 * square);
  });
  normalise_signs(curvature);
  return response(light, curvature, normalised_gaussian(deviation));
}

}  // namespace penumbra
