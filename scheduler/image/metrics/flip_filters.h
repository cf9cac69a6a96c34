// The linear filters of FLIP: sums of separable kernels, applied to planes of floats.
#pragma once

#include <functional>
#include <vector>

namespace penumbra {

/// One value per pixel, row by row.
struct Plane {
  int width = 0, height = 0;
  std::vector<float> values;

  Plane() = default;
  Plane(int w, int h) : width(w), height(h), values(std::size_t(w) * std::size_t(h)) {}
};

/// Weights w[-radius] … w[radius]. Kernels whose weights sum to zero are applied to differences from the
/// central value, so that constant regions give exactly 0. FLIP takes roots of the responses, which would
/// amplify rounding errors.
struct Kernel {
  std::vector<double> weights;
  bool sums_to_zero = false;

  [[nodiscard]] int radius() const { return int(weights.size() / 2); }
};

/// The sum over j, i of down[j] across[i] source(x + i, y + j). Beyond the border the nearest pixel is used.
Plane convolve(const Plane& source, const Kernel& across, const Kernel& down);

/// The contrast sensitivity of one opponent channel as a filter (Andersson et al. 2020, eq. 2 and table 1):
/// g(x) = a1 sqrt(pi / b1) exp(-pi^2 x^2 / b1) + a2 sqrt(pi / b2) exp(-pi^2 x^2 / b2), x in degrees.
struct Sensitivity {
  double a1, b1, a2, b2;
};
constexpr Sensitivity kLightSensitivity{1, 0.0047, 0, 1e-5};
constexpr Sensitivity kRedGreenSensitivity{1, 0.0053, 0, 1e-5};
constexpr Sensitivity kBlueYellowSensitivity{34.1, 0.04, 13.5, 0.025};

/// The source filtered with that kernel, normalised to sum 1.
Plane filter_by_sensitivity(const Plane& source, const Sensitivity& sensitivity, double pixels_per_degree);

/// The responses of edge and point detectors (section 4.3 of the paper): the length of the vector of
/// horizontal and vertical responses. The kernels are first and second derivatives of a Gaussian of standard
/// deviation 0.082 / 2 degrees; positive weights are normalised to sum 1 and negative ones to sum -1.
Plane edge_response(const Plane& light, double pixels_per_degree);
Plane point_response(const Plane& light, double pixels_per_degree);

/// Calls body(y0, y1) for bands of rows on several threads. body must not throw.
void for_bands(int height, const std::function<void(int y0, int y1)>& body);

}  // namespace penumbra
