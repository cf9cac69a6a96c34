#include "scenes/bsdfs/thin_film.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <vector>

#include "scenes/angles.h"
#include "scenes/spectrum.h"

namespace penumbra {
namespace {

using Complex = std::complex<double>;

/// Amplitudes of one polarisation at the two boundaries.
struct Amplitudes {
  Complex first, second;
};
/// Both polarisations, and the cosine in the film; imaginary where it is reflected totally.
struct FilmAmplitudes {
  Amplitudes s, p;
  Complex cosine;
};

FilmAmplitudes amplitudes(const ThinFilm& film, double cosine) {
  const double sine2 = 1 - cosine * cosine, n = film.index;
  const Complex m2 = Complex(film.base, film.absorbed) * Complex(film.base, film.absorbed);
  // Index times cosine in the film and beyond.
  const Complex in = std::sqrt(Complex(n * n - sine2)), out = std::sqrt(m2 - sine2);
  const auto quotient = [](Complex a, Complex b) {
    const Complex sum = a + b;
    return sum == Complex(0) ? Complex(0) : (a - b) / sum;  // two that vanish are those of equal media
  };
  return {{quotient(cosine, in), quotient(in, out)},
          {quotient(n * n * cosine, in), quotient(m2 * in, n * n * out)},
          in / n};
}

/// By the phase factor of the way through the film and back.
double reflected(const Amplitudes& r, Complex factor) {
  const Complex back = r.second * factor;
  return std::min(std::norm((r.first + back) / (1.0 + r.first * back)), 1.0);
}
double reflected(const FilmAmplitudes& r, Complex factor) {
  return 0.5 * (reflected(r.s, factor) + reflected(r.p, factor));
}

/// The mean over all phases, for real amplitudes at the first boundary: intensities add.
double incoherent(const Amplitudes& r) {
  const double first = std::norm(r.first), second = std::min(std::norm(r.second), 1.0);
  return first + (1 - first) * (1 - first) * second / std::max(1 - first * second, 1e-12);
}

/// The way back and forth in wavelengths is this over the wavelength.
Complex path(const ThinFilm& film, Complex cosine) { return 2 * film.optical * film.nanometres * cosine; }
Complex phase_factor(Complex path, double wavelength) {
  return std::exp(Complex(0, 2 * kPi / wavelength) * path);
}

struct Weight {
  double wavelength;
  glm::dvec3 weight;  ///< the sum of all is white
};
const std::vector<Weight>& weights() {
  static const auto table = [] {
    constexpr double kFirst = 380, kLast = 780, kStep = 5;  // nm
    std::vector<Weight> result;
    glm::dvec3 sum(0);
    for (double nanometres = kFirst; nanometres <= kLast; nanometres += kStep) {
      result.push_back({nanometres, reflectance_weight(nanometres)});
      sum += result.back().weight;
    }
    for (Weight& each : result) each.weight /= sum;
    return result;
  }();
  return table;
}

/// k of the index n + i k of a metal that reflects r along the normal.
double metal_absorption(double r, double n) {
  return std::sqrt(std::max(0.0, (r * std::pow(n + 1, 2) - std::pow(n - 1, 2)) / (1 - r)));
}

/// n of the metal that reflects r along the normal, and at the cosine 1 / 7 as much as Schlick's reflectance.
double metal_index(double r) {
  constexpr double kCosine = 1.0 / 7;
  const double wanted = r + (1 - r) * std::pow(1 - kCosine, 5), root = std::sqrt(r);
  // The most has no absorption, and dims towards grazing angles at first.
  double low = (1 - r) / (1 + r), high = (1 + root) / (1 - root);
  for (int i = 0; i < 60; ++i) {
    const double n = 0.5 * (low + high);
    const ThinFilm bare{
        .index = 1, .optical = 1, .base = n, .nanometres = 0, .absorbed = metal_absorption(r, n)};
    (film_reflectance(bare, kCosine, 550) > wanted ? low : high) = n;
  }
  return 0.5 * (low + high);
}

}  // namespace

double film_reflectance(const ThinFilm& film, double cosine, double wavelength) {
  const FilmAmplitudes r = amplitudes(film, cosine);
  return reflected(r, phase_factor(path(film, r.cosine), wavelength));
}

glm::dvec3 film_colour(const ThinFilm& film, double cosine) {
  // Neighbouring wavelengths of the table must not be a turn apart.
  constexpr double kLongest = 12'000;  // nm
  const FilmAmplitudes r = amplitudes(film, cosine);
  const Complex way = path(film, r.cosine);
  if (way.real() > kLongest) return glm::dvec3(0.5 * (incoherent(r.s) + incoherent(r.p)));
  glm::dvec3 colour(0);
  for (const Weight& each : weights())
    colour += reflected(r, phase_factor(way, each.wavelength)) * each.weight;
  return glm::clamp(colour, 0.0, 1.0);
}

glm::dvec3 film_on_metal(ThinFilm film, double reflectance, double cosine) {
  const double r = reflectance;
  if (r >= 1) return glm::dvec3(0);
  film.base = metal_index(r);
  film.absorbed = metal_absorption(r, film.base);
  ThinFilm none = film;
  none.nanometres = 0;
  return film_colour(film, cosine) - film_colour(none, cosine);
}

}  // namespace penumbra
