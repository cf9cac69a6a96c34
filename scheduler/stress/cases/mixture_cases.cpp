// Plastics, Ward's and Blinn's lobes beside a diffuse base, and microfacets of conductors and dielectrics,
// from mirrors to flat lobes; Fresnel's equations.
#include <fmt/format.h>

#include "kernels/bsdf/families.h"
#include "scheduler/stress/cases/cases.h"
#include "scheduler/stress/cases/inputs.h"
#include "scheduler/stress/quantity_list.h"
#include "scheduler/stress/truth/mixtures.h"

namespace penumbra::stress {
namespace mixture_cases {
namespace {

constexpr double kDiffuse = .3, kSpecular = .6, kInternal = .6;
constexpr int kGrid = 64;

struct Mixture {
  std::string name, stiff;
  int family, variant = 0;
  double ior = 1.5, alpha_u = 0, alpha_v = 0, exponent = 0;
  double most_weight = 0;  ///< of a sample; 0: any
  double width = 0;        ///< of the lobe, in slopes
  bool transmits = false;  ///< whether the value is that of light from beneath
};

std::vector<Mixture> mixtures() {
  std::vector<Mixture> all;
  const std::pair<const char*, int> variants[] = {
      {"ward", WARD_ORIGINAL}, {"ward-duer", WARD_DUER}, {"ward-balanced", WARD_BALANCED}};
  for (const auto& [name, variant] : variants)
    for (const auto& [alpha, u, v] :
         {std::tuple("1e-4", 1e-4, 1e-4), std::tuple("1e-4-by-1", 1e-4, 1.0), std::tuple("1", 1.0, 1.0)})
      // Of the balanced one cos / (wo . h h.z), at most 2.
      all.push_back({.name = fmt::format("{}-{}", name, alpha),
                     .stiff = fmt::format("a Ward lobe of roughness {}", alpha),
                     .family = FAMILY_WARD,
                     .variant = variant,
                     .alpha_u = u,
                     .alpha_v = v,
                     .most_weight = variant == WARD_BALANCED ? 2 * (kDiffuse + kSpecular) : 0,
                     .width = u});
  for (const auto& [name, n] : {std::pair("0", 0.0), std::pair("30", 30.0), std::pair("1e5", 1e5)})
    all.push_back(
        {.name = fmt::format("blinnphong-{}", name),
         .stiff = fmt::format("a Blinn-Phong lobe of exponent {}", name),
         .family = FAMILY_BLINNPHONG,
         .exponent = n,
         .most_weight = (kDiffuse + kSpecular) * (n + 2) * (n + 4) / ((n + 1) * (std::exp2(-n / 2) + n)),
         .width = 1 / std::sqrt(n + 1)});
  for (const auto& [name, ior] :
       {std::pair("1+1e-7", 1 + 2 * kUlp), std::pair("1.5", 1.5), std::pair("3.5", 3.5)})
    all.push_back({.name = fmt::format("plastic-{}", name),
                   .stiff = fmt::format("a plastic of refractive index {}", name),
                   .family = FAMILY_PLASTIC,
                   .ior = ior,
                   .most_weight = kSpecular / std::min(1.0, ior * ior * (1 - kInternal)),
                   .width = .1});
  for (const auto& [name, alpha] : {std::pair("1e-4", 1e-4), std::pair("1", 1.0)}) {
    const Mixture ggx{.name = "",
                      .stiff = fmt::format("GGX microfacets of roughness {}", alpha),
                      .family = 0,
                      .alpha_u = alpha,
                      .alpha_v = alpha,
                      .most_weight = kSpecular,
                      .width = alpha};
    Mixture conductor = ggx, reflected = ggx, transmitted = ggx;
    conductor.name = fmt::format("ggx-conductor-{}", name);
    conductor.family = FAMILY_ROUGHCONDUCTOR_GGX;
    reflected.name = fmt::format("ggx-dielectric-{}", name);
    transmitted.name = fmt::format("ggx-dielectric-{}-through", name);
    reflected.family = transmitted.family = FAMILY_ROUGHDIELECTRIC_GGX;
    transmitted.transmits = true;
    all.insert(all.end(), {conductor, reflected, transmitted});
  }
  return all;
}

Numbers closure_of(const Mixture& m) {
  return {double(m.family), double(m.variant), kDiffuse,  kSpecular, m.ior,
          kInternal,        m.alpha_u,         m.alpha_v, m.exponent};
}

QuadFunction value_function(const Mixture& m, bool pdf) {
  const int family = m.family, variant = m.variant;
  return [family, variant, pdf](const Quads& in) {
    const MixtureDirections d{quad(in, 0), quad(in, 3)};
    const MixtureValue v =
        family == FAMILY_ROUGHCONDUCTOR_GGX    ? ggx_conductor(in[7], in[8], in[9], in[10], in[11], d)
        : family == FAMILY_ROUGHDIELECTRIC_GGX ? ggx_dielectric(in[7], in[8], in[10], in[11], d)
        : family == FAMILY_WARD                ? ward_mixture(variant, in[6], in[7], in[10], in[11], d)
        : family == FAMILY_BLINNPHONG          ? blinnphong_mixture(in[6], in[7], in[12], d)
                                               : plastic_base(in[6], in[7], in[8], in[9], d);
    return Quads{pdf ? v.pdf : v.f_cos};
  };
}

void add_values(const Mixture& m, std::vector<Case>& cases) {
  // The half vector leans by as many widths of the lobe.
  const std::tuple<const char*, const char*, double, double> pairs[] = {
      {"peak", "the peak", .5, 0},
      {"shoulder", "a width off the peak", .5, 1},
      {"grazing", "grazing", 1.5, .3}};
  for (const auto& [pair, where, tilt, widths] : pairs) {
    const double lean = std::atan(widths * std::min(m.width, .3)), angle = tilt - 2 * lean;
    const double refracted = std::asin(std::sin(tilt - lean) / m.ior) + lean;
    const Points directions{{std::sin(tilt), 0, std::cos(tilt)},
                            m.transmits ? Point{-std::sin(refracted), 0, -std::cos(refracted)}
                                        : Point{-std::sin(angle), 0, std::cos(angle)}};
    Numbers inputs = floats({}, closure_of(m)), order = floats(directions);
    for (const double v : floats(directions)) inputs.push_back(v);
    for (std::size_t i = 2; i < 9; ++i) order.push_back(inputs[i]);
    for (const bool pdf : {false, true}) {
      const QuadFunction f = value_function(m, pdf);
      Allowed allowed{1e-30, 3e-6, "directions off by 2^-22; a dozen roundings, exp and log", {}};
      allowed.computed = [f, order] {
        std::vector<double> deltas = rounding(quads(order), 2, 4 * kUlp);
        std::fill(deltas.begin() + 6, deltas.end(), 0.0);
        return sensitivity(f, quads(order), deltas);
      };
      cases.push_back({fmt::format("mixture/{}-{}{}", pair, m.name, pdf ? "-pdf" : ""),
                       fmt::format("{}, {}", m.stiff, where), pdf ? "density, 1/sr" : "f cos, 1/sr",
                       KernelMeasurement{QUANTITY_MIXTURE_VALUE, inputs, outputs(pdf ? 1 : 0, 1)},
                       truth_of(f, order, "the definition in 113 bits"), allowed});
    }
  }
}

void add_samples(const Mixture& m, std::vector<Case>& cases) {
  for (const auto& [name, cosine] :
       {std::pair("normal", 1.0), std::pair("1e-3", 1e-3), std::pair("1e-6", 1e-6)}) {
    Numbers inputs = floats({}, closure_of(m));
    const double sine = std::sqrt(1 - cosine * cosine);
    for (const double v : floats({{.6 * sine, .8 * sine, cosine}}, {kGrid})) inputs.push_back(v);
    const double most = m.most_weight;
    cases.push_back(
        {fmt::format("mixture/weights-{}-{}", name, m.name),
         fmt::format("{}, seen under a cosine of {}", m.stiff, cosine),
         most > 0 ? "samples that are none, and what their weights exceed their bound by"
                  : "samples that are none",
         KernelMeasurement{QUANTITY_MIXTURE_SAMPLES, inputs,
                           [most](const Numbers& out) {
                             return Numbers{out[1] + (most > 0 ? worst({0.0, out[0] - most}) : 0)};
                           }},
         known(0, "quotients of the definitions"), absolute(1e-5, "rounding")});
  }
}

void add_fresnel(std::vector<Case>& cases) {
  struct Entry {
    const char *name, *stiff;
    double ior, k;
  };
  const Entry entries[] = {{"1+1e-7", "a refraction that all but changes nothing", 1 + 2 * kUlp, 1},
                           {"1-1e-7", "total reflection in a sliver of directions", 1 - 2 * kUlp, .01},
                           {"1.5", "glass", 1.5, 1},
                           {"0.67", "glass from inside", 0.67, 3},
                           {"100", "an index of 100", 100, 1e4}};
  for (const Entry& e : entries) {
    for (const auto& [name, cosine] : {std::pair("normal", 1.0), std::pair("1e-3", 1e-3),
                                       std::pair("1e-6", 1e-6), std::pair("0.745", 0.745)}) {
      const Numbers inputs = {rounded(cosine), rounded(e.ior), rounded(e.k)};
      const std::tuple<const char*, const char*, QuadFunction> outcomes[] = {
          {"dielectric", "reflectance",
           [](const Quads& in) { return Quads{boundary_fresnel(in[0], in[1]).reflectance}; }},
          {"refracted", "cosine beyond",
           [](const Quads& in) { return Quads{boundary_fresnel(in[0], in[1]).cosine}; }},
          {"conductor", "reflectance",
           [](const Quads& in) { return Quads{conductor_fresnel(in[0], in[1], in[2])}; }}};
      std::size_t at = 0;
      for (const auto& [of, quantity, f] : outcomes) {
        Allowed allowed{
            1e-30, 2e-6, "some twenty roundings, the first of them near angles of total reflection", {}};
        allowed.computed = [f, inputs] {
          std::vector<double> deltas;
          for (const double v : inputs) deltas.push_back(kUlp * v);
          return sensitivity(f, quads(inputs), deltas);
        };
        cases.push_back({fmt::format("fresnel/{}-{}-{}", of, e.name, name),
                         fmt::format("{}, under a cosine of {}", e.stiff, cosine), quantity,
                         KernelMeasurement{QUANTITY_FRESNEL, inputs, outputs(at++, 1)},
                         truth_of(f, inputs, "the definition in 113 bits"), allowed});
      }
    }
  }
}

}  // namespace

void add(std::vector<Case>& cases) {
  for (const Mixture& m : mixtures()) {
    add_values(m, cases);
    if (!m.transmits) add_samples(m, cases);
  }
  add_fresnel(cases);
}

}  // namespace mixture_cases

void add_mixture_cases(std::vector<Case>& cases) { mixture_cases::add(cases); }

}  // namespace penumbra::stress
