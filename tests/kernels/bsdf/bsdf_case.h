// A BSDF to test: a row of bsdf_cases.h.
#pragma once

#include <ostream>
#include <string>

#include "kernels/host/device_scene.h"
#include "tests/kernels/kernels_under_test.h"

namespace penumbra {

struct BsdfCase {
  std::string name;
  Material made;           ///< as the scene builder makes it
  double most_weight = 1;  ///< of a sample's f cos / pdf, in any channel
  double steepness = 0;  ///< of other than GGX and Beckmann: |d ln f| per radian that wo or wi turns, at most
  double most_energy = 1;    ///< that leaves for what arrives, see bsdf_test.cpp
  bool fits_a_grid = true;   ///< its lobe is wider than the steps of the grid there
  bool all_is_found = true;  ///< from above, all directions that are sampled leave the surface

  [[nodiscard]] const Material& material() const { return made; }
  [[nodiscard]] Closure closure() const { return closure_of(made); }
  [[nodiscard]] bool is_ggx() const {
    return made.family == FAMILY_ROUGHCONDUCTOR_GGX || made.family == FAMILY_ROUGHDIELECTRIC_GGX;
  }
  [[nodiscard]] bool has(int properties) const {
    return ((families_with(properties) >> made.family) & 1u) != 0;
  }
};

inline void PrintTo(const BsdfCase& bsdf_case, std::ostream* out) { *out << bsdf_case.name; }

inline vec3 grey(double value) { return make_vec3(float(value), float(value), float(value)); }

inline Material empty_material(int family) {
  Material m{};
#define NO_TEXTURE(_, type, name) m.name##_texture = -1;
  TEXTURED_FIELDS(NO_TEXTURE, _)
#undef NO_TEXTURE
  m.family = family;
  return m;
}

inline bool is_thin_sheet(const Closure& c) {
  return c.family == FAMILY_PRINCIPLEDTHIN || c.family == FAMILY_DIFFTRANS || c.family == FAMILY_HAIR;
}

/// Refractive index where wi leads, over that where wo does. A thin sheet has the same on both sides.
inline double index_ratio(const Closure& c, const vec3& wi) {
  return wi.z < 0 && !is_thin_sheet(c) ? double(c.ior) : 1.0;
}

/// Of one that transmits.
inline Closure seen_from_behind(const Closure& c) {
  Closure behind = c;
  if (c.family == FAMILY_PRINCIPLED_TRANSMITTING) behind.variant = PRINCIPLED_INSIDE - c.variant;
  if (!is_thin_sheet(c)) behind.ior = 1 / c.ior;
  return behind;
}

}  // namespace penumbra
