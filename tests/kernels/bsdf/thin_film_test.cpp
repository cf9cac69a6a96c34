// Airy's formulas against characteristic matrices, and the colours of films against a finer quadrature.
#include "scenes/bsdfs/thin_film.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include "scenes/spectrum.h"
#include "tests/kernels/random_numbers.h"

namespace penumbra {
namespace {

using Real = long double;
using Complex = std::complex<Real>;

/// The reflectance by the characteristic matrix of the film (Born and Wolf 1999, section 1.6; Macleod 2010,
/// section 2.5), by admittances of the tangential fields.
Real by_matrices(const ThinFilm& film, Real cosine, Real wavelength) {
  const Real sine2 = 1 - cosine * cosine;
  const Complex base(Real(film.base), Real(film.absorbed));
  const auto cosine_in = [&](Complex index) { return std::sqrt(Real(1) - sine2 / (index * index)); };
  const Complex in = cosine_in(Real(film.index)), out = cosine_in(base);
  const Complex delta =
      2 * std::numbers::pi_v<Real> * Real(film.optical) * Real(film.nanometres) * in / wavelength;
  const Complex i(0, 1);
  Real sum = 0;
  for (const bool s : {true, false}) {
    const auto admittance = [&](Complex index, Complex c) { return s ? index * c : index / c; };
    const Complex before = admittance(1, cosine), own = admittance(Real(film.index), in),
                  behind = admittance(base, out);
    // By waves exp(-i omega t), whose indices have imaginary parts above 0.
    const Complex b = std::cos(delta) - i * std::sin(delta) / own * behind,
                  c = -i * own * std::sin(delta) + std::cos(delta) * behind;
    sum += std::norm((before * b - c) / (before * b + c));
  }
  return sum / 2;
}

TEST(ThinFilm, ReflectsWhatCharacteristicMatricesSay) {
  RandomNumbers random(3);
  for (int k = 0; k < 5000; ++k) {
    ThinFilm film;
    film.optical = random.between(1, 3), film.index = film.optical / random.between(1, 2);
    film.base = random.between(0.4, 3), film.nanometres = random.between(0, 2000);
    const double cosine = random.between(0.01, 1), wavelength = random.between(380, 780);
    if (k % 2 == 0) film.absorbed = random.between(0, 4);
    // Evanescent waves of thick films overflow in the matrices.
    EXPECT_NEAR(film_reflectance(film, cosine, wavelength),
                double(by_matrices(film, Real(cosine), Real(wavelength))), 1e-9)
        << k;
  }
}

TEST(ThinFilm, AQuarterWaveOfTheMeanIndexReflectsNothing) {
  for (const double base : {1.5, 2.0, 4.0}) {
    const double index = std::sqrt(base);
    EXPECT_NEAR(film_reflectance({index, index, base, 550 / (4 * index)}, 1, 550), 0, 1e-12);
    // And half a wave is as if it were not there.
    EXPECT_NEAR(film_reflectance({index, index, base, 550 / (2 * index)}, 1, 550),
                std::pow((base - 1) / (base + 1), 2), 1e-12);
  }
}

double fresnel(double cosine, double ior) {
  const double t = std::sqrt(std::max(0.0, 1 - (1 - cosine * cosine) / (ior * ior)));
  if (t == 0) return 1;
  const double s = (cosine - ior * t) / (cosine + ior * t), p = (ior * cosine - t) / (ior * cosine + t);
  return 0.5 * (s * s + p * p);
}

TEST(ThinFilm, WithoutThicknessOrContrastReflectsByFresnelsEquations) {
  for (const double cosine : {1.0, 0.5, 0.1, 1e-3})
    for (const double base : {0.6, 1.0, 1.5, 3.0})
      for (int channel = 0; channel < 3; ++channel) {
        EXPECT_NEAR(film_colour({1.4, 1.4, base, 0}, cosine)[channel], fresnel(cosine, base), 1e-9);
        EXPECT_NEAR(film_colour({1, 1, base, 300}, cosine)[channel], fresnel(cosine, base), 1e-9);
        EXPECT_NEAR(film_colour({base, 1.4, base, 300}, cosine)[channel], fresnel(cosine, base), 1e-9);
      }
}

TEST(ThinFilm, HasTheColoursOfAFineQuadrature) {
  double furthest = 0;
  for (const double nanometres : {20.0, 150.0, 400.0, 900.0, 2500.0, 3900.0, 5000.0, 50'000.0})
    for (const double base : {0.7, 1.5, 3.0})
      for (const double cosine : {1.0, 0.6, 0.2}) {
        const ThinFilm film{1.5, 1.5, base, nanometres};
        glm::dvec3 sum(0), white(0);
        // Thick films have several fringes a nanometre.
        constexpr double kStep = 0.02;
        for (double wavelength = 360; wavelength <= 830; wavelength += kStep) {
          const glm::dvec3 weight = reflectance_weight(wavelength);
          sum += film_reflectance(film, cosine, wavelength) * weight, white += weight;
        }
        const glm::dvec3 expected = glm::clamp(sum / white, 0.0, 1.0), colour = film_colour(film, cosine);
        for (int channel = 0; channel < 3; ++channel)
          furthest = std::max(furthest, std::abs(colour[channel] - expected[channel]));
      }
  // Of matching functions that end at 380 and 780 nm, and of fringes of more than 12 micrometres.
  EXPECT_LT(furthest, 2e-3);
}

TEST(ThinFilm, AddsNothingToAMetalThatReflectsAllNorWithoutThickness) {
  for (const double cosine : {1.0, 0.5, 0.05})
    for (int channel = 0; channel < 3; ++channel) {
      EXPECT_NEAR(film_on_metal({1.5, 1.5, 1, 300}, 1, cosine)[channel], 0, 1e-12);
      EXPECT_NEAR(film_on_metal({1.5, 1.5, 1, 300}, 1 - 1e-9, cosine)[channel], 0, 1e-6);
      EXPECT_EQ(film_on_metal({1.5, 1.5, 1, 0}, 0.4, cosine)[channel], 0);
    }
  // A black metal with a film reflects what the film does.
  EXPECT_NEAR(film_on_metal({1.5, 1.5, 1, 300}, 0, 1).y, film_colour({1.5, 1.5, 1, 300}, 1).y, 1e-12);
}

TEST(ThinFilm, OfAnyKindReflectsBetweenNothingAndAll) {
  for (const double index : {1.0, 1.5, 3.0})
    for (const double base : {0.3, 1.0, 3.0, 100.0})
      for (const double nanometres : {0.0, 1.0, 1e4, 1e6, 1e7})
        for (const double cosine : {1.0, 0.1, 1e-4, 1e-8})
          for (int channel = 0; channel < 3; ++channel) {
            const double r = film_colour({index, index, base, nanometres}, cosine)[channel];
            EXPECT_TRUE(r >= 0 && r <= 1) << index << ' ' << base << ' ' << nanometres << ' ' << cosine;
          }
}

}  // namespace
}  // namespace penumbra
