// The linear filters of FLIP: sums of separable kernels on planes of floats.
#pragma once

#include <functional>
#include <vector>

namespace penumbra {

/// One value for each pixel, row by row.
struct Plane {
  int width = 0, height = 0;
  std::vector<float> values;

  Plane() = default;
  Plane(int w, int h) : width(w), height(h), values(std::size_t(w) * std::size_t(h)) {}
};

/// Weights w[-radius] … w[radius]. Those that sum to zero are applied to differences from the middle value,
/// so that they give exactly 0 where nothing changes: FLIP takes roots of the responses, and rounding would
/// grow.
struct Kernel {
  std::vector<double> weights;
  bool sums_to_zero = false;

  [[nodiscard]] int radius() const { return int(weights.size() / 2); }
};

/// sum over j, i of down[j] across[i] source(x + i, y + j); beyond the border the nearest pixel counts.
Plane convolve(const Plane& source, const Kernel& across, const Kernel& down);

/// Contrast sensitivity of one opponent channel as a filter (Andersson et al. 2020, eq. 2 and table 1):
/// g(x) = a1 sqrt(pi / b1) exp(-pi^2 x^2 / b1) + a2 sqrt(pi / b2) exp(-pi^2 x^2 / b2), x in degrees.
struct Sensitivity {
  double a1, b1, a2, b2;
};
constexpr Sensitivity kLightSensitivity{1, 0.0047, 0, 1e-5};
constexpr Sensitivity kRedGreenSensitivity{1, 0.0053, 0, 1e-5};
constexpr Sensitivity kBlueYellowSensitivity{34.1, 0.04, 13.5, 0.025};

/// The source through that filter, normalised to sum 1.
Plane filter_by_sensitivity(const Plane& source, const Sensitivity& sensitivity, double pixels_per_degree);

/// Responses of detectors of edges and of points (section 4.3 there), as the length of the vector of the
/// responses across and down: first and second derivatives of a Gaussian of standard deviation 0.082 / 2
/// degrees, positive weights normalised to sum 1 and negative ones to -1.
Plane edge_response(const Plane& light, double pixels_per_degree);
Plane point_response(const Plane& light, double pixels_per_degree);

/// body(y0, y1) on bands of rows, in several threads; must not throw.
void for_bands(int height, const std::function<void(int y0, int y1)>& body);

}  // namespace penumbra
