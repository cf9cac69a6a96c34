// BSDFs that hold others, and what they hold where there is nothing. A BSDF holds only such as come before
// it.
#pragma once

#include "scenes/bsdfs/material.h"
#include "scenes/plugin_values.h"

namespace penumbra {

/// Holds one BSDF for both sides, or two.
struct TwoSidedParameters {
  static constexpr const char* kPlugin = "twosided";
  static constexpr const char* kText = "a BSDF without transmission for both sides, or one for each side";

  template <typename Row>
  static void parameters(const Row&) {}
};

/// A sum of several BSDFs, each with its weight.
struct MixtureParameters {
  static constexpr const char* kPlugin = "mixturebsdf";
  static constexpr const char* kText = "several BSDFs, each with a weight";
  std::string weights;

  template <typename Row>
  static void parameters(const Row& row) {
    row("weights", &MixtureParameters::weights, AnyText{"numbers, 1 at most together"},
        "share of each BSDF, in order");
  }
};

/// In the place of an index of a BSDF: it absorbs everything; there is none, so that rays pass through.
constexpr int kBlackBsdf = -1;
constexpr int kNoBsdf = -2;

/// Index of its material among those of a device scene, where the black one comes first; -1: nothing.
constexpr int material_index(int bsdf) { return bsdf + 1; }

/// Rays pass through as if it were not there. If it belongs to a light, that shines all the same.
struct NullBsdf {
  static constexpr const char* kPlugin = "null";
  static constexpr const char* kText = "no surface: rays pass through, as at the boundary of a medium";

  template <typename Row>
  static void parameters(const Row&) {}
};

/// Rays pass through, as many as the opacity leaves.
struct MaskBsdf {
  static constexpr const char* kPlugin = "mask";
  static constexpr const char* kText = "a BSDF with an opacity: other rays pass through";
  TexturedNumber opacity{0.5f};
  int inside = kBlackBsdf;

  template <typename Row>
  static void parameters(const Row& row) {
    row("opacity", &MaskBsdf::opacity, NumberWithin{}, "share of the rays that meet the bsdf inside");
  }
};

/// A filter of polarised light, as light without polarisation goes through it: half, or of a retarder all, of
/// `transmittance`; the rest is absorbed (Mitsuba 3 in its unpolarised variants).
struct PolarizerParameters {
  static constexpr const char* kPlugin = "polarizer";
  static constexpr const char* kText = "polarising filter: lets half of the light pass (a retarder: all)";
  TexturedNumber transmittance{1.0f};

  template <typename Row>
  static void parameters(const Row& row) {
    row("transmittance", &PolarizerParameters::transmittance, NumberWithin{},
        "of the light that its polarisation lets through");
  }
};

/// One or the other, the sum of both so weighed.
struct BlendBsdf {
  static constexpr const char* kPlugin = "blendbsdf";
  static constexpr const char* kText = "two BSDFs, mixed by a weight";
  TexturedNumber weight{0.5f};
  int first = kBlackBsdf, second = kBlackBsdf;

  template <typename Row>
  static void parameters(const Row& row) {
    row("weight", &BlendBsdf::weight, NumberWithin{}, "share of the second bsdf inside");
  }
};

/// `weight` of the second; values of its texture beyond [0, 1] are clamped.
inline Material branching_material(int first, int second, const TexturedNumber& weight) {
  Material m = material_of_family(FAMILY_BLACK);
  m.branches = 1;
  m.first = material_index(first);
  m.second = material_index(second);
  set_field(m.weight, m.weight_texture, weight);
  return m;
}

inline Material material_of(const NullBsdf&) {
  Material m = material_of_family(FAMILY_BLACK);
  m.passes = PASSES_ALL;
  return m;
}
inline Material material_of(const MaskBsdf& mask) {
  return branching_material(kNoBsdf, mask.inside, mask.opacity);
}
inline Material material_of(const BlendBsdf& blend) {
  return branching_material(blend.first, blend.second, blend.weight);
}

}  // namespace penumbra
