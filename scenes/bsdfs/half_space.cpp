#include "scenes/bsdfs/half_space.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

namespace penumbra {
namespace {

constexpr int kStreams = 16;
using Row = std::array<double, kStreams>;
using Matrix = std::array<Row, kStreams>;

Matrix operator*(const Matrix& a, const Matrix& b) {
  Matrix c{};
  for (std::size_t i = 0; i < kStreams; ++i)
    for (std::size_t k = 0; k < kStreams; ++k)
      for (std::size_t j = 0; j < kStreams; ++j) c[i][j] += a[i][k] * b[k][j];
  return c;
}

Matrix operator+(Matrix a, const Matrix& b) {
  for (std::size_t i = 0; i < kStreams; ++i)
    for (std::size_t j = 0; j < kStreams; ++j) a[i][j] += b[i][j];
  return a;
}

/// The solution X of (1 - A) X = B, for A of norm below 1: no pivots are needed.
Matrix over_complement(const Matrix& a, Matrix b) {
  Matrix m{};
  for (std::size_t i = 0; i < kStreams; ++i)
    for (std::size_t j = 0; j < kStreams; ++j) m[i][j] = (i == j ? 1.0 : 0.0) - a[i][j];
  for (std::size_t k = 0; k < kStreams; ++k)
    for (std::size_t i = 0; i < kStreams; ++i) {
      if (i == k) continue;
      const double factor = m[i][k] / m[k][k];
      for (std::size_t j = k; j < kStreams; ++j) m[i][j] -= factor * m[k][j];
      for (std::size_t j = 0; j < kStreams; ++j) b[i][j] -= factor * b[k][j];
    }
  for (std::size_t i = 0; i < kStreams; ++i)
    for (std::size_t j = 0; j < kStreams; ++j) b[i][j] /= m[i][i];
  return b;
}

/// Legendre polynomials of degrees below 2 kStreams at x.
std::array<double, 2 * kStreams> legendre(double x) {
  std::array<double, 2 * kStreams> p{1, x};
  for (std::size_t l = 2; l < p.size(); ++l)
    p[l] = (double(2 * l - 1) * x * p[l - 1] - double(l - 1) * p[l - 2]) / double(l);
  return p;
}

/// The points and weights of Gauss's quadrature over cosines in [0, 1].
struct Cosines {
  Row cosine{}, weight{};
  Cosines() {
    for (std::size_t i = 0; i < kStreams; ++i) {
      double x = std::cos(std::numbers::pi * (double(i) + 0.75) / (kStreams + 0.5)), slope = 1;
      for (int step = 0; step < 20; ++step) {
        const auto p = legendre(x);
        slope = kStreams * (x * p[kStreams] - p[kStreams - 1]) / (x * x - 1);
        x -= p[kStreams] / slope;
      }
      cosine[i] = (1 + x) / 2;
      weight[i] = 1 / ((1 - x * x) * slope * slope);
    }
  }
};

/// See HalfSpace, by doubling a thin layer until nothing passes. Matrices act on the radiances of the
/// cosines.
double doubled_albedo(double single, double g) {
  if (!(single > 0)) return 0;
  static const Cosines at;
  const double ahead = std::pow(g, 2 * kStreams);  // delta-M: what is scattered straight on
  const double albedo = single * (1 - ahead) / (1 - single * ahead);
  constexpr int kFirst = -26;
  const double depth = std::ldexp(1.0, kFirst);
  Matrix reflects{}, passes{};
  for (std::size_t i = 0; i < kStreams; ++i)
    for (std::size_t j = 0; j < kStreams; ++j) {
      const auto out = legendre(at.cosine[i]), in = legendre(at.cosine[j]);
      double forward = 0, backward = 0, moment = 1;
      for (std::size_t l = 0; l < out.size(); ++l, moment *= g) {
        const double term = double(2 * l + 1) * (moment - ahead) / (1 - ahead) * out[l] * in[l];
        forward += term;
        backward += l % 2 == 0 ? term : -term;
      }
      const double once = albedo * depth / (2 * at.cosine[i]) * at.weight[j];
      reflects[i][j] = once * backward;
      passes[i][j] = once * forward + (i == j ? 1 - depth / at.cosine[i] : 0.0);
    }
  constexpr int kMostDoublings = 80;
  for (int k = 0; k < kMostDoublings; ++k) {
    // Light that goes to and fro between the two layers.
    const Matrix between = over_complement(reflects * reflects, passes);
    const Matrix back = reflects * between;
    const Matrix through = passes * between;
    reflects = reflects + passes * back;
    passes = through;
    double most = 0;
    for (const Row& row : passes) most = std::max(most, *std::ranges::max_element(row));
    if (most < 1e-12) break;
  }
  double sum = 0;
  for (std::size_t i = 0; i < kStreams; ++i)
    for (std::size_t j = 0; j < kStreams; ++j) sum += 2 * at.cosine[i] * at.weight[i] * reflects[i][j];
  return sum;
}

/// Chebyshev points of the second kind in [0, 1], ascending.
double node(int k, int count) { return (1 - std::cos(std::numbers::pi * k / (count - 1))) / 2; }

double single_by_root(double s, double g) { return (1 - s * s) / (1 - g * s * s); }

}  // namespace

HalfSpace::HalfSpace(double g) : g_(g) {
  // Without absorption all comes back; of black media nothing.
  albedos_.front() = 1;
  for (int k = 1; k + 1 < kNodes; ++k)
    albedos_[std::size_t(k)] = doubled_albedo(single_by_root(node(k, kNodes), g), g);
}

double HalfSpace::albedo_by_root(double s) const {
  // The barycentric formula (Berrut and Trefethen 2004).
  double above = 0, below = 0;
  for (int k = 0; k < kNodes; ++k) {
    const double away = s - node(k, kNodes), value = albedos_[std::size_t(k)];
    if (away == 0) return value;
    const double weight = (k % 2 == 0 ? 1.0 : -1.0) * (k == 0 || k == kNodes - 1 ? 0.5 : 1.0) / away;
    above += weight * value;
    below += weight;
  }
  return above / below;
}

double HalfSpace::albedo(double single) const {
  return albedo_by_root(std::sqrt(std::max((1 - single) / (1 - g_ * single), 0.0)));
}

double HalfSpace::single_albedo(double albedo) const {
  if (!(albedo > 0)) return 0;
  if (albedo >= 1) return 1;
  double low = 0, high = 1;  // the albedo falls with the root
  for (int step = 0; step < 60; ++step) {
    const double middle = (low + high) / 2;
    (albedo_by_root(middle) > albedo ? low : high) = middle;
  }
  return single_by_root((low + high) / 2, g_);
}

std::vector<float> HalfSpace::curve() const {
  std::vector<float> roots(CURVE_STRIDE, 0.0f);
  for (int k = 0; k < CURVE_KNOTS; ++k)
    roots[std::size_t(k)] = float(std::sqrt(1 - single_albedo(double(k) / (CURVE_KNOTS - 1))));
  return roots;
}

const HalfSpace& half_space(float g) {
  thread_local std::map<float, HalfSpace> known;
  return known.try_emplace(g, double(g)).first->second;
}

}  // namespace penumbra
