// BSDFs that hold other BSDFs, and special values for absent children. A BSDF may hold only BSDFs with
// smaller indices.
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

/// Special values of a BSDF index: kBlackBsdf absorbs all light; with kNoBsdf there is no surface, so rays
/// pass through.
constexpr int kBlackBsdf = -1;
constexpr int kNoBsdf = -2;

/// The index of the BSDF's material in the device scene, whose first material is the black one. -1 for
/// kNoBsdf.
constexpr int material_index(int bsdf) { return bsdf + 1; }

/// An invisible surface: rays pass through it unchanged. If the shape is an emitter, its light is still
/// visible.
struct NullBsdf {
  static constexpr const char* kPlugin = "null";
  static constexpr const char* kText = "no surface: rays pass through, as at the boundary of a medium";

  template <typename Row>
  static void parameters(const Row&) {}
};

/// A mask: the fraction 1 - opacity of all rays passes through.
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

/// A polarising filter or retarder as it acts on unpolarised light. A filter transmits half of
/// `transmittance`, a retarder all of it; the rest is absorbed (as in Mitsuba 3's unpolarised variants).
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

/// A linear blend of two BSDFs.
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

/// A material that chooses between two children. `weight` is that of the second; texture values outside [0,
/// 1] are clamped.
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
