// Directional albedos of GGX microfacets and of the fuzz, for the curves of OpenPBR's surface.
#pragma once

#include <compare>
#include <cstddef>
#include <optional>
#include <vector>

#include "scenes/bsdfs/thin_film.h"

namespace penumbra {

/// What microfacets scatter of the light from a direction, after a single reflection or refraction, with
/// Smith's separable masking.
struct FacetAlbedo {
  double plain = 1;      ///< if they reflect all light
  double reflected = 0;  ///< by Fresnel's equations
  double scattered = 1;  ///< reflected or refracted by them
  double refracted = 1;  ///< if they refract all light, but where reflection is total
};

/// The albedos for roughnesses alpha in (0, 2], a refractive index above 0 of the other side over that of the
/// direction's side, and a direction at `cosine` in (0, 1], whose tangential part has the square of the sine
/// `across` of its angle with the direction of alpha_u. To 6e-4; below an index of 1, where total reflection
/// begins with a step, to 1.4e-3 and the share that is refracted to 3.1e-3.
FacetAlbedo facet_albedo(double alpha_u, double alpha_v, double ior, double cosine, double across);

/// Directional albedo of fuzz of this roughness in [0, 1]: see fuzz_lobe (kernels/bsdf/openpbr.h). To 5e-4.
double fuzz_albedo(double roughness, double cosine);

/// The mean of Fresnel's reflectance over a cosine-weighted hemisphere. To 1e-5.
double mean_fresnel(double ior);

/// How the rows of OpenPBR's curves differ.
enum class FacetRows {
  kOne,        ///< there is one
  kRoughness,  ///< by roughness, see facet_place (kernels/bsdf/openpbr.h)
  kAzimuth     ///< by the square of the sine of the angle with the direction of alpha_u, from 0 to 1
};

/// What OpenPBR's curves depend on.
struct FacetCurves {
  FacetRows rows = FacetRows::kOne;
  double alpha_u = 0.09, alpha_v = 0.09;  ///< of the base; 0 where rows differ by roughness
  double ior = 1.5;                       ///< of the base
  bool layered = false;                   ///< without, only the first set is there
  bool transmits = false;                 ///< without, the set of `scattered` is not needed and holds ones
  double coat_alpha = 0, coat_ior = 1;    ///< without a coat the index is 1
  double fuzz_roughness = -1;             ///< -1: there is no fuzz
  bool gltf = false;                      ///< whether the fuzz, and what transmits, is glTF's
  /// The film of the first and of the last thickness, of layered ones; and how many thicknesses there are.
  std::optional<ThinFilm> film;
  double last_nanometres = 0;
  int film_rows = 0;

  friend auto operator<=>(const FacetCurves&, const FacetCurves&) = default;

  [[nodiscard]] int row_count() const;
  [[nodiscard]] int sets() const;
  /// One set of rows after the other; after a row's knots follows the mean of the curve, interpolated as in
  /// the kernels, over a cosine-weighted hemisphere. Behind them are the blocks of a film
  /// (kernels/bsdf/thin_film.h).
  [[nodiscard]] std::vector<float> curves() const;
  [[nodiscard]] std::size_t size() const;  ///< of these

 private:
  /// The microfacets of a row.
  struct FacetRow {
    double alpha_u, alpha_v, across;
    double alpha;  ///< where rows differ by roughness
  };
  [[nodiscard]] FacetRow row_of(std::size_t row) const;
  [[nodiscard]] std::vector<float> film_blocks() const;
};

}  // namespace penumbra
