// The roughness parameters of microfacet BSDFs.
#pragma once

#include "scenes/bsdfs/material.h"
#include "scenes/plugin_values.h"

namespace penumbra {

struct RoughSurface {
  int distribution = DISTRIBUTION_BECKMANN;
  TexturedNumber alpha{0.1f};
  TexturedNumber alpha_u{0.1f}, alpha_v{0.1f};  ///< after `complete` these are used instead of alpha
  bool sample_visible = true;

  template <typename Row>
  static void parameters(const Row& row) {
    row("distribution", &RoughSurface::distribution,
        OneOf<int>{{{"beckmann", DISTRIBUTION_BECKMANN}, {"ggx", DISTRIBUTION_GGX}}},
        "how the microfacets are distributed");
    row("alpha", &RoughSurface::alpha, NumberWithin{LowEnd::kClosed, 0.0f, kMostAlpha},
        "roughness; raised to 0.0001 if smaller");
    row("alpha_u", &RoughSurface::alpha_u, NumberWithin{LowEnd::kClosed, 0.0f, kMostAlpha},
        "roughness along the tangent, with alpha_v instead of alpha");
    row("alpha_v", &RoughSurface::alpha_v, NumberWithin{LowEnd::kClosed, 0.0f, kMostAlpha},
        "roughness across the tangent");
    row("sample_visible", &RoughSurface::sample_visible, TrueOrFalse{},
        "accepted; visible microfacets are sampled always");
  }

  template <typename Given>
  void complete(Findings& findings, const Given& given) {
    if (given("alpha") && (given("alpha_u") || given("alpha_v")))
      findings.push_back({"alpha", "give either alpha, or alpha_u and alpha_v"});
    else if (given("alpha_u") != given("alpha_v"))
      findings.push_back({given("alpha_u") ? "alpha_u" : "alpha_v", "give both, alpha_u and alpha_v"});
    else if (!given("alpha_u"))
      alpha_u = alpha_v = alpha;
  }

  [[nodiscard]] int family(int ggx, int beckmann) const {
    return distribution == DISTRIBUTION_GGX ? ggx : beckmann;
  }
  void set_roughness(Material& m) const {
    PENUMBRA_SET_FIELD(m, alpha_u, alpha_u);
    PENUMBRA_SET_FIELD(m, alpha_v, alpha_v);
  }

  static constexpr float kMostAlpha = 100.0f;  ///< the kernels' MOST_ALPHA
};

}  // namespace penumbra
