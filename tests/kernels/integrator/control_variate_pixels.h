// Pixels under control variates, drawn from a model whose moments are known in closed form.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

#include "kernels/integrator/control_variate.h"
#include "tests/kernels/random_numbers.h"
#include "tests/support/statistics.h"

namespace penumbra {

struct Pixel {
  std::vector<float> h, w, g;

  explicit Pixel(int n) : h(std::size_t(n)), w(std::size_t(n)), g(std::size_t(n)) {}

  void copy(int to, const Pixel& pixel, int from) {
    h[std::size_t(to)] = pixel.h[std::size_t(from)];
    w[std::size_t(to)] = pixel.w[std::size_t(from)];
    g[std::size_t(to)] = pixel.g[std::size_t(from)];
  }
  [[nodiscard]] int count() const { return int(h.size()); }
  [[nodiscard]] float auto_alpha(int half, int parity = 0) const {
    return cross_fitted_alpha(h.data(), w.data(), g.data(), 1, count(), parity, half);
  }
  [[nodiscard]] float estimate(int i, float alpha) const {
    const auto s = std::size_t(i);
    return (h[s] - alpha * w[s]) + alpha * g[s];
  }
  /// Count, mean and squared deviations of the samples' estimates.
  [[nodiscard]] statistics::Sample estimates() const {
    const std::array alpha{auto_alpha(0), auto_alpha(1)};
    statistics::Sample sample;
    for (int i = 0; i < count(); ++i) sample.add(estimate(i, alpha[std::size_t(i & 1)]));
    return sample;
  }
};

/// Rays at a uniform x in [0, 1) with w = G (k + 1) x^k, so that E[w] = G. What blocks them does so at x
/// above an edge, or below it with `bright`, such that a fraction `visible` of G remains.
struct Model {
  int power = 2;  // k: 0 constant, 2 as noisy as area samples of a large near light, 30 a highlight
  double visible = 0.5;
  bool bright = false;   // the large w are the visible ones
  bool varying = false;  // G is uniform in [.1, 1.9] instead of 1
  bool moving = false;   // `visible` is uniform in [0, 1] instead, and grows with G
  int rays = 4;

  [[nodiscard]] double k() const { return power; }
  /// E[w^2] / G^2
  [[nodiscard]] double square() const { return (k() + 1) * (k() + 1) / (2 * k() + 1); }
  /// E[w^2 V] / G^2
  [[nodiscard]] double visible_square() const {
    const double c = edge(visible), below = std::pow(c, 2 * k() + 1);
    return square() * (bright ? 1 - below : below);
  }
  [[nodiscard]] double edge(double f) const { return std::pow(bright ? 1 - f : f, 1 / (k() + 1)); }
  [[nodiscard]] double mean_g_squared() const { return varying ? 1 + 0.9 * 0.9 / 3 : 1; }
  /// E[H]: for a moving edge, the mean of (.1 + 1.8 u) u over u in [0, 1]
  [[nodiscard]] double mean() const { return !moving ? visible : varying ? 0.05 + 0.6 : 0.5; }
  /// Variance of one sample's estimate with a fixed alpha. The edge must not move.
  [[nodiscard]] double variance(double alpha) const {
    const double q = visible_square(), f = visible;
    return mean_g_squared() / rays * (q - f * f - 2 * alpha * (q - f) + alpha * alpha * (square() - 1)) +
           f * f * (mean_g_squared() - 1);
  }
  /// The alpha of the least variance.
  [[nodiscard]] double best() const { return power == 0 ? 0 : (visible_square() - visible) / (square() - 1); }

  void draw(RandomNumbers& random, Pixel& pixel) const {
    for (std::size_t i = 0; i < pixel.h.size(); ++i) {
      const double u = random.uniform(), g = varying ? 0.1 + 1.8 * u : 1;
      const double c = edge(moving ? u : visible);
      double h = 0, w = 0;
      for (int ray = 0; ray < rays; ++ray) {
        const double x = random.uniform();
        double weight = g * (k() + 1) / rays;
        for (int j = 0; j < power; ++j) weight *= x;
        w += weight;
        h += (x < c) != bright ? weight : 0;
      }
      pixel.h[i] = float(h);
      pixel.w[i] = float(w);
      pixel.g[i] = float(g);
    }
  }
  [[nodiscard]] std::string name() const {
    return "k " + std::to_string(power) + ", visible " + std::to_string(visible) +
           (bright ? " bright" : " dim") + (varying ? ", G varies" : "") + ", rays " + std::to_string(rays);
  }
};

}  // namespace penumbra
