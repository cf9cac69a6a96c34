// Phase functions with a peak, free flights from 0 to the last digit, weights of channels that are orders
// apart, and distances by the angle about a light.
#include <fmt/format.h>

#include "scheduler/stress/cases/cases.h"
#include "scheduler/stress/cases/inputs.h"
#include "scheduler/stress/quantity_list.h"

namespace penumbra::stress {
namespace medium_cases {
namespace {

/// 1 - |mu| of a share u of Henyey and Greenstein's lobe, towards its peak.
Quad hg_versine(Quad g, Quad u) {
  const Quad m = abs_q(g), rest = 1 - m, at = rest + 2 * m * u;
  return 2 * rest * rest * (1 - u) * (1 + m * u) / (at * at);
}

void add_phase(std::vector<Case>& cases) {
  for (const auto& [name, value] : {std::pair("forward-.9999", .9999), std::pair("backward-.9999", -.9999),
                                    std::pair("forward-.9999999", .9999999), std::pair("isotropic", 0.)}) {
    const Quad g = rounded(value), m = abs_q(g);
    const std::string stiff = fmt::format("Henyey-Greenstein scattering with g = {}", value);
    for (const auto& [place, versine] :
         {std::pair("peak", 0.), std::pair("beside", 1e-12), std::pair("shoulder", 1e-8),
          std::pair("side", 1.), std::pair("back", 2.)}) {
      const Quad v = rounded(versine);
      cases.push_back({fmt::format("media/hg-{}-{}", name, place),
                       stiff,
                       "density in 1 / sr",
                       KernelMeasurement{QUANTITY_PHASE, {double(g), double(v), .5, 1}, {}},
                       {[g, m, v] {
                          const Quad square = (1 - m) * (1 - m) + 2 * m * v;
                          return Quads{(1 - g * g) / (4 * kQuadPi * square * sqrt_q(square))};
                        },
                        "the definition in 113 bits"},
                       relative(16 * kUlp, "16 roundings, of sums of what is positive")});
    }
    for (const auto& [place, share] : {std::pair("u-0", 0.), std::pair("u-2^-24", kUlp),
                                       std::pair("u-.5", .5), std::pair("u-1", kBelow1)}) {
      const Quad u = share;
      cases.push_back({fmt::format("media/hg-{}-{}", name, place),
                       stiff,
                       "sine and cosine of a sampled angle",
                       KernelMeasurement{QUANTITY_PHASE, {double(g), 0, double(u), 1}, outputs(1, 2)},
                       {[g, u] {
                          const Quad versine = hg_versine(g, u);
                          const Quad cosine = 1 - versine;
                          return Quads{sqrt_q(versine * (1 + cosine)), g < 0 ? -cosine : cosine};
                        },
                        "the inverse of the distribution function in 113 bits"},
                       absolute(16 * kUlp, "16 roundings of a unit vector")});
    }
    constexpr int kCells = 4096;
    cases.push_back({fmt::format("media/hg-{}-moments", name),
                     stiff,
                     "mean cosine and second Legendre moment of 4096 samples",
                     KernelMeasurement{QUANTITY_PHASE, {double(g), 0, .5, kCells}, outputs(3, 2)},
                     {[g] {
                        Quad first = 0, second = 0;
                        for (int i = 0; i < kCells; ++i) {
                          const Quad cosine = 1 - hg_versine(g, (i + Quad(.5)) / kCells),
                                     mu = g < 0 ? -cosine : cosine;
                          first += mu;
                          second += Quad(1.5) * mu * mu - Quad(.5);
                        }
                        return Quads{first / kCells, second / kCells};
                      },
                      "the same samples in 113 bits"},
                     absolute(48 * kUlp, "16 roundings of a unit vector, thrice in the moment")});
  }
}

void add_flights(std::vector<Case>& cases) {
  struct Entry {
    const char* name;
    double u, fine;
  };
  const Entry entries[] = {{"u-0", 0, 0},    {"u-2^-48", 0, kUlp},      {"u-2^-24", kUlp, 0},
                           {"u-.5", .5, .5}, {"u-below-1", kBelow1, 0}, {"u-1", kBelow1, kBelow1}};
  for (const Entry& e : entries)
    cases.push_back(
        {fmt::format("media/free-flight-{}", e.name),
         "free flights of the least and the largest numbers",
         "optical depth",
         KernelMeasurement{QUANTITY_FLIGHT_DEPTH, {e.u, e.fine}, {}},
         {[e] { return Quads{-log1p_q(-(Quad(e.u) + Quad(e.fine) * kUlp))}; }, "the definition in 113 bits"},
         relative(10 * kUlp, "a logarithm's 3e-7 and four roundings")});
}

void add_weights(std::vector<Case>& cases) {
  struct Entry {
    const char *name, *stiff;
    Point extinction;
    double length;
  };
  const Entry entries[] = {
      {"optical-depth-1e-8", "a flight through an optical depth of 1e-8", {1e-8, 2e-8, 4e-8}, 1},
      {"optical-depth-100", "channels of which two underflow beside the third", {100, 200, 400}, 1},
      {"optical-depth-1e8", "channels of which all underflow", {1e8, 1.00000016e8, 2e8}, 1},
      {"orders-apart", "channels of which one lets all through and one nothing", {1e-8, 1, 1e8}, 1},
      {"long-and-thin", "extinctions below the smallest float's root", {1e-25, 2e-25, 0}, 1e25}};
  const Point albedo{.5, 1, .25};
  for (const Entry& e : entries)
    for (const bool scatters : {false, true}) {
      const Numbers inputs = floats({e.extinction, albedo}, {e.length, scatters ? 1. : 0.});
      const auto weights = [inputs, scatters] {
        Quads passes, values, result;
        Quad sum = 0;
        const Quad length = inputs[6];
        Quad least = inputs[0];
        for (std::size_t k = 1; k < 3; ++k) least = min_q(least, inputs[k]);
        for (std::size_t k = 0; k < 3; ++k) {
          const Quad sigma = inputs[k], density = exp_q(-(sigma - least) * length) * (scatters ? sigma : 1);
          passes.push_back(density);
          values.push_back(density * (scatters ? Quad(inputs[3 + k]) : 1));
          sum += density / 3;
        }
        for (const Quad value : values) result.push_back(value / sum);
        for (const Quad pass : passes) result.push_back(pass / sum);
        return result;
      };
      // Exponents of what does not underflow are below 88 and round to 2 ulps of them.
      cases.push_back({fmt::format("media/weight-{}-{}", e.name, scatters ? "scattered" : "passed"),
                       e.stiff,
                       "throughputs and ratios of densities of three channels",
                       KernelMeasurement{QUANTITY_FLIGHT_WEIGHT, inputs, outputs(0, 6)},
                       {weights, "the definition in 113 bits"},
                       absolute(3 * 16 * kUlp + 2 * kUlp / 2.718,
                                "16 roundings of weights of at most 3; of exponents x, 2 x e^-x of an ulp")});
    }
}

/// Of the inputs of QUANTITY_SIGHT: the distance, the angle.
Quads sight(const Quads& in) {
  const Quad3 d = normalize(quad(in, 3)), to = quad(in, 6) - quad(in, 0);
  const Quad along = dot(to, d), apart = length(cross(d, to));
  const Quad away = max_q(apart, max_q(in[10], abs_q(along) * Quad(1e-4f)));
  const Quad from = atan2_q(-along, away), angle = atan2_q(in[9] - along, away) - from;
  const Quad at = from + in[11] * angle;
  return {along + away * sin_q(at) / cos_q(at), angle};
}

/// What the inputs cost that are each off by four roundings, for one of the two.
double sight_rounding(const Numbers& inputs, std::size_t which) {
  const Quads at = quads(inputs);
  std::vector<double> deltas = rounding(at, 3, 4 * kUlp);
  for (std::size_t i = 9; i < 12; ++i) deltas[i] = 4 * kUlp * inputs[i];
  return sensitivity([which](const Quads& in) { return Quads{sight(in)[which]}; }, at, deltas);
}

void add_sights(std::vector<Case>& cases) {
  struct Entry {
    const char *name, *stiff;
    Point place;
    double length, size;
  };
  const Entry entries[] = {{"through", "a ray through the light", {0, 0, .5}, 1, 0},
                           {"near", "a light 1e-3 from the ray", {1e-3, 0, .5}, 1, 0},
                           {"far", "a light 1e4 away", {1e4, 0, 10}, 1, 0},
                           {"behind", "a light behind the ray", {.1, 0, -3}, 1, 0},
                           {"short", "a ray of 1e-8", {1, 0, 0}, 1e-8, 0},
                           {"large", "a light as large as the ray is long", {0, .1, .5}, 1, 1}};
  for (const Entry& e : entries) {
    const auto add = [&](const std::string& what, const char* quantity, double u, std::size_t which) {
      const Numbers inputs = floats({{0, 0, 0}, {0, 0, 1}, e.place}, {e.length, e.size, u});
      cases.push_back(
          {fmt::format("media/sight-{}-{}", e.name, what),
           e.stiff,
           quantity,
           KernelMeasurement{QUANTITY_SIGHT, inputs, outputs(which, 1)},
           {[inputs, which] { return Quads{sight(quads(inputs))[which]}; }, "tangents in 113 bits"},
           {1e-30, 16 * kUlp, "16 roundings, and four of each input to first order",
            [inputs, which] { return sight_rounding(inputs, which); }}});
    };
    for (const auto& [name, u] : {std::pair("u-0", 0.), std::pair("u-.5", .5), std::pair("u-1", kBelow1)})
      add(name, "distance at a share of the angle", u, 0);
    add("angle", "the angle that a ray takes as seen from a light", .5, 1);
  }
}

}  // namespace

void add(std::vector<Case>& cases) {
  add_phase(cases);
  add_flights(cases);
  add_weights(cases);
  add_sights(cases);
}

}  // namespace medium_cases

void add_medium_cases(std::vector<Case>& cases) { medium_cases::add(cases); }

}  // namespace penumbra::stress
