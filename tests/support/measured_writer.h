// Files of measured BRDFs (scenes/measured_file.h), made of formulas.
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <functional>
#include <glm/glm.hpp>
#include <numbers>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace penumbra {

/// A tensor file, field by field.
class TensorWriter {
 public:
  template <typename T>
  void add(std::string_view name, std::uint8_t type, const std::vector<std::uint64_t>& shape,
           const std::vector<T>& values) {
    std::string bytes(values.size() * sizeof(T), '\0');
    std::memcpy(bytes.data(), values.data(), bytes.size());
    fields_.push_back({std::string(name), type, shape, std::move(bytes)});
  }
  void add(std::string_view name, const std::vector<std::uint64_t>& shape, const std::vector<float>& values) {
    add(name, 10, shape, values);
  }
  [[nodiscard]] std::string file() const {
    std::string head("tensor_file\0\1\0", 14), data;
    put(head, std::uint32_t(fields_.size()));
    std::size_t size = head.size();
    for (const Field& f : fields_) size += 2 + f.name.size() + 2 + 1 + 8 + 8 * f.shape.size();
    for (const Field& f : fields_) {
      put(head, std::uint16_t(f.name.size()));
      head += f.name;
      put(head, std::uint16_t(f.shape.size()));
      put(head, f.type);
      put(head, std::uint64_t(size + data.size()));
      for (const std::uint64_t side : f.shape) put(head, side);
      data += f.bytes;
    }
    return head + data;
  }

 private:
  struct Field {
    std::string name;
    std::uint8_t type;
    std::vector<std::uint64_t> shape;
    std::string bytes;
  };
  template <typename T>
  static void put(std::string& to, T value) {
    static_assert(std::endian::native == std::endian::little);
    to.append(reinterpret_cast<const char*>(&value), sizeof value);
  }
  std::vector<Field> fields_;
};

/// A BRDF by formulas, in the frame of the normal, and the sizes of its file.
struct MeasuredFormula {
  std::function<double(const glm::dvec3& m)> density;  ///< of microfacets' normals; in any unit
  /// f cos for the wo and wi of reflection; a channel of `wavelengths`, or of linear Rec. 709.
  std::function<double(const glm::dvec3& wo, const glm::dvec3& wi, std::size_t channel)> f_cos;
  std::vector<double> phi{0.0};  ///< of wo, in radians; one: isotropic
  std::vector<double> theta;
  std::vector<float> wavelengths;              ///< in nm; none: an rgb file
  int vndf = 32, luminance = 16, facets = 64;  ///< knots along each side
  bool by_facets = true;
};

inline std::vector<double> evenly(double first, double last, int count) {
  std::vector<double> values;
  for (int i = 0; i < count; ++i) values.push_back(std::lerp(first, last, i / (count - 1.0)));
  return values;
}

inline glm::dvec3 at_angles(double theta, double phi) {
  return {std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)};
}
/// The half vector at a point of the square.
inline glm::dvec3 half_vector_at(double u, double v) {
  return at_angles(u * u * std::numbers::pi / 2, (2 * v - 1) * std::numbers::pi);
}
/// Solid angle of half vectors by area of the square.
inline double half_vector_area(double u) {
  return 2 * std::numbers::pi * std::numbers::pi * u * std::sin(u * u * std::numbers::pi / 2);
}

/// A bilinear density on `side` x `side` knots of the unit square.
class MeasuredWarp {
 public:
  MeasuredWarp(int side, std::vector<double> density) : side_(side), density_(std::move(density)) {}

  /// The point that has the share x of its row to the left, and y of all below it.
  [[nodiscard]] glm::dvec2 at(double x, double y) const {
    std::vector<double> rows;
    for (int row = 0; row < side_; ++row) {
      double sum = 0;
      for (int i = 0; i + 1 < side_; ++i) sum += 0.5 * (knot(i, row) + knot(i + 1, row));
      rows.push_back(sum);
    }
    const double v = place(rows, y);
    const int row = std::min(int(v), side_ - 2);
    std::vector<double> between;
    for (int i = 0; i < side_; ++i) between.push_back(std::lerp(knot(i, row), knot(i, row + 1), v - row));
    return glm::dvec2(place(between, x), v) / (side_ - 1.0);
  }

 private:
  [[nodiscard]] double knot(int i, int row) const { return density_[std::size_t(row * side_ + i)]; }
  /// Where the share `part` of what is linear between values is to the left.
  static double place(const std::vector<double>& values, double part) {
    double whole = 0;
    for (std::size_t i = 0; i + 1 < values.size(); ++i) whole += 0.5 * (values[i] + values[i + 1]);
    double rest = part * whole;
    for (std::size_t i = 0; i + 1 < values.size(); ++i) {
      const double a = values[i], b = values[i + 1], cell = 0.5 * (a + b);
      if (rest > cell && i + 2 < values.size()) {
        rest -= cell;
        continue;
      }
      const double root = std::sqrt(std::max(a * a + 2 * rest * (b - a), 0.0));
      return double(i) + (a + root > 0 ? std::clamp(2 * rest / (a + root), 0.0, 1.0) : 0.0);
    }
    return double(values.size()) - 1;
  }

  int side_;
  std::vector<double> density_;
};

/// Bilinear between the knots of a square.
inline double between_knots(const std::vector<float>& values, int side, double u, double v) {
  const double x = u * (side - 1), y = v * (side - 1);
  const int i = std::min(int(x), side - 2), j = std::min(int(y), side - 2);
  const auto at = [&](int a, int b) { return double(values[std::size_t((j + b) * side + i + a)]); };
  return std::lerp(std::lerp(at(0, 0), at(1, 0), x - i), std::lerp(at(0, 1), at(1, 1), x - i), y - j);
}

/// The fields of a formula's file: what the paper's method would give of it without errors of measurement. At
/// its knots, the file has the values of the formula.
inline TensorWriter measured_fields(const MeasuredFormula& formula) {
  constexpr double kPi = std::numbers::pi;
  const bool isotropic = formula.phi.size() == 1;
  const auto knots = [](int side) {
    std::vector<double> all = evenly(0, 1, side);
    return all;
  };
  std::vector<float> ndf, sigma, vndf, luminance, colours;
  for (const double v : knots(formula.facets))
    for (const double u : knots(formula.facets)) ndf.push_back(float(formula.density(half_vector_at(u, v))));
  // Projected areas, by midpoints.
  constexpr int kParts = 128;
  struct Facet {
    glm::dvec3 m;
    double weight;
  };
  std::vector<Facet> all;
  for (int i = 0; i < kParts; ++i)
    for (int j = 0; j < kParts; ++j) {
      const double u = (i + 0.5) / kParts;
      const glm::dvec3 m = half_vector_at(u, (j + 0.5) / kParts);
      all.push_back({m, formula.density(m) * half_vector_area(u) / (kParts * kParts)});
    }
  constexpr int kSigma = 16;
  std::vector<float> row;
  for (const double v : knots(kSigma))
    for (const double u : knots(kSigma)) {
      if (isotropic && v > 0) {
        sigma.push_back(sigma[sigma.size() - kSigma]);
        continue;
      }
      const glm::dvec3 wo = half_vector_at(u, v);
      double sum = 0;
      for (const Facet& each : all) sum += each.weight * std::max(glm::dot(wo, each.m), 0.0);
      sigma.push_back(float(sum));
    }
  const std::size_t channels = formula.wavelengths.empty() ? 3 : formula.wavelengths.size();
  for (const double phi : formula.phi)
    for (const double theta : formula.theta) {
      const glm::dvec3 wo = at_angles(theta, isotropic ? 0.0 : phi);
      std::vector<double> density;
      for (const double v : knots(formula.vndf))
        for (const double u : knots(formula.vndf)) {
          const glm::dvec3 m = half_vector_at(u, v);
          density.push_back(formula.density(m) * std::max(glm::dot(wo, m), 0.0) * half_vector_area(u));
          vndf.push_back(float(density.back()));
        }
      const MeasuredWarp warp(formula.vndf, density);
      const double projected =
          between_knots(sigma, kSigma, std::sqrt(theta * 2 / kPi), isotropic ? 0.5 : 0.5 + phi / (2 * kPi));
      std::vector<std::vector<float>> spectra(channels);
      for (const double y : knots(formula.luminance))
        for (const double x : knots(formula.luminance)) {
          const glm::dvec2 at = warp.at(x, y);
          const glm::dvec3 m = half_vector_at(at.x, at.y), wi = 2 * glm::dot(wo, m) * m - wo;
          const double facets = between_knots(ndf, formula.facets, at.x, at.y) / (4 * projected);
          const bool there = wi.z > 0 && wo.z > 0 && (!formula.by_facets || facets > 0);
          double mean = 0;
          for (std::size_t k = 0; k < channels; ++k) {
            const double value = there ? formula.f_cos(wo, wi, k) / (formula.by_facets ? facets : 1.0) : 0.0;
            spectra[k].push_back(float(value));
            mean += value / double(channels);
          }
          luminance.push_back(float(mean));
        }
      for (const auto& each : spectra) colours.insert(colours.end(), each.begin(), each.end());
    }
  const auto single = [](const std::vector<double>& values) {
    return std::vector<float>(values.begin(), values.end());
  };
  const std::uint64_t phis = formula.phi.size(), thetas = formula.theta.size(),
                      facets = std::uint64_t(formula.facets), side = std::uint64_t(formula.vndf),
                      colour_side = std::uint64_t(formula.luminance);
  TensorWriter file;
  const std::string text = "a formula";
  file.add("description", 1, {text.size()}, std::vector<char>(text.begin(), text.end()));
  file.add("jacobian", 1, {1}, std::vector<std::uint8_t>{std::uint8_t(formula.by_facets ? 1 : 0)});
  file.add("phi_i", {phis}, single(formula.phi));
  file.add("theta_i", {thetas}, single(formula.theta));
  file.add("ndf", {facets, facets}, ndf);
  file.add("sigma", {kSigma, kSigma}, sigma);
  file.add("vndf", {phis, thetas, side, side}, vndf);
  file.add("luminance", {phis, thetas, colour_side, colour_side}, luminance);
  if (!formula.wavelengths.empty()) file.add("wavelengths", {channels}, formula.wavelengths);
  file.add(formula.wavelengths.empty() ? "rgb" : "spectra",
           {phis, thetas, channels, colour_side, colour_side}, colours);
  return file;
}

/// GGX microfacets that reflect the shares `colour` of light.
inline double ggx_density(const glm::dvec3& m, double alpha_u, double alpha_v) {
  const double q = m.x * m.x / (alpha_u * alpha_u) + m.y * m.y / (alpha_v * alpha_v) + m.z * m.z;
  return 1 / (std::numbers::pi * alpha_u * alpha_v * q * q);
}
inline double ggx_lambda(const glm::dvec3& w, double alpha_u, double alpha_v) {
  const double across = w.x * w.x * alpha_u * alpha_u + w.y * w.y * alpha_v * alpha_v;
  return 0.5 * (std::sqrt(1 + across / (w.z * w.z)) - 1);
}
/// f cos with Smith's masking of correlated heights.
inline double ggx_reflection(const glm::dvec3& wo, const glm::dvec3& wi, double alpha_u, double alpha_v) {
  const glm::dvec3 m = glm::normalize(wo + wi);
  return ggx_density(m, alpha_u, alpha_v) / (4 * wo.z) /
         (1 + ggx_lambda(wo, alpha_u, alpha_v) + ggx_lambda(wi, alpha_u, alpha_v));
}

inline MeasuredFormula isotropic_formula(double alpha = 0.4) {
  MeasuredFormula formula;
  formula.density = [=](const glm::dvec3& m) { return ggx_density(m, alpha, alpha); };
  formula.f_cos = [=](const glm::dvec3& wo, const glm::dvec3& wi, std::size_t channel) {
    constexpr double kColour[] = {0.9, 0.6, 0.3};
    return kColour[channel] * ggx_reflection(wo, wi, alpha, alpha);
  };
  formula.theta = evenly(0, std::numbers::pi / 2, 9);
  return formula;
}

/// Azimuths over a half turn, by which it is the same.
inline MeasuredFormula anisotropic_formula() {
  constexpr double kAlphaU = 0.6, kAlphaV = 0.25;
  MeasuredFormula formula;
  formula.density = [=](const glm::dvec3& m) { return ggx_density(m, kAlphaU, kAlphaV); };
  formula.f_cos = [=](const glm::dvec3& wo, const glm::dvec3& wi, std::size_t channel) {
    constexpr double kColour[] = {0.9, 0.6, 0.3};
    return kColour[channel] * ggx_reflection(wo, wi, kAlphaU, kAlphaV);
  };
  formula.phi = evenly(-std::numbers::pi, 0, 9);
  formula.theta = evenly(0, std::numbers::pi / 2, 7);
  return formula;
}

/// No material: no facets beyond an angle, and no light in a stripe of directions; not reciprocal, and not
/// the same by any turn. Its colours have no factor of facets.
inline MeasuredFormula strange_formula() {
  MeasuredFormula formula;
  formula.density = [](const glm::dvec3& m) { return m.z > 0.7 ? 0.2 + m.z * m.z + 0.5 * m.x : 0.0; };
  formula.f_cos = [](const glm::dvec3&, const glm::dvec3& wi, std::size_t channel) {
    return std::abs(wi.x) < 0.25 ? 0.0 : (0.1 + 0.05 * double(channel)) * (1 + wi.y) * wi.z;
  };
  formula.phi = evenly(-std::numbers::pi, std::numbers::pi, 6);
  formula.theta = evenly(0, 1.5, 4);
  formula.vndf = 16, formula.luminance = 12, formula.facets = 16;
  formula.by_facets = false;
  return formula;
}

}  // namespace penumbra
