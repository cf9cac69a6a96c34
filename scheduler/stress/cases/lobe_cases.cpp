// The closed form of polygon lights: reflection in a Phong lobe.
#include <fmt/format.h>

#include "scheduler/stress/cases/cases.h"
#include "scheduler/stress/cases/polygon_setting.h"
#include "scheduler/stress/truth/quadrature.h"

namespace penumbra::stress {
namespace lobe_cases {
namespace {

// The documented bounds of polygon_terms.
constexpr double kBound = 2e-10, kSmallBound = 3e-15;
const std::string kWhy = "documented bound of polygon_terms: its Gauss-Legendre rules";
const char* kQuantity = "(e + 2) / (2 pi) times the integral of max(0, w.u)^e n.u";

struct Axis {
  const char *name, *stiff;
  PolygonSetting setting;
};

const std::vector<Axis>& axes() {
  static const std::vector<Axis> list = {
      {"centre", "the lobe inside the light", {{square(1, 1)}}},
      {"edge", "the lobe on an edge of the light", {{square(1, 1)}, {}, {0, 0, 1}, unit(1, .2, 1)}},
      {"vertex", "the lobe on a vertex of the light", {{square(1, 1)}, {}, {0, 0, 1}, unit(1, 1, 1)}},
      {"beside", "the lobe 2 degrees beside the light", {{square(1, 1)}, {}, {0, 0, 1}, unit(1.07, 0, 1)}},
      {"grazing",
       "the lobe along the horizon, which cuts the light",
       {{{{1, 1, -.5}, {1, -1, -.5}, {1, -1, .5}, {1, 1, .5}}}, {}, {0, 0, 1}, unit(1, .1, 1e-6)}},
  };
  return list;
}

struct Exponent {
  const char* name;
  int value;
};
constexpr Exponent kExponents[] = {{"0", 0},     {"1", 1},      {"2", 2},       {"33", 33},
                                   {"100", 100}, {"1e3", 1000}, {"1e4", 10000}, {"1e5", 100000}};

void add(std::vector<Case>& cases, const std::string& name, const std::string& stiff, PolygonSetting s,
         int exponent, Allowed allowed) {
  s.exponent = exponent;
  cases.push_back({"lobe/" + name,
                   stiff,
                   kQuantity,
                   measurement(s, true),
                   {[s, exponent] {
                      const Quad value = lobe(quad_loops(s), quad(s.x), quad(s.n), quad(s.w), exponent);
                      return Quads{max_q(value, 0)};
                    },
                    "Arvo's recurrence for clipped triangles in 113 bits"},
                   std::move(allowed)});
}

/// For exponents that are no integers: over the square at height 1, which the lobe's front faces.
Quad square_lobe(Quad exponent, const Quad3& w) {
  const auto at = [&](Quad x, Quad y) {
    const Quad3 p{x, y, 1};
    const Quad r = length(p), cosine = dot(w, p) / r;
    return exp_q(exponent * log_q(cosine)) / (r * r * r * r);
  };
  const auto row = [&](Quad y) { return tanh_sinh([&](Quad x) { return at(x, y); }, -1, 1); };
  return (exponent + 2) / (2 * kQuadPi) * tanh_sinh(row, -1, 1);
}

}  // namespace

void add(std::vector<Case>& cases) {
  for (const Axis& axis : axes()) {
    for (const Exponent& e : kExponents)
      add(cases, fmt::format("{}-{}", axis.name, e.name), fmt::format("{}, exponent {}", axis.stiff, e.name),
          axis.setting, e.value, absolute(kBound, kWhy));
  }
  for (const double exponent : {.5, 2.5, 17.3}) {
    PolygonSetting s{{square(1, 1)}, {}, {0, 0, 1}, unit(.3, .1, 1), exponent};
    cases.push_back({fmt::format("lobe/real-{}", exponent),
                     "an exponent that is no integer",
                     kQuantity,
                     measurement(s, true),
                     {[s] { return Quads{square_lobe(s.exponent, quad(s.w))}; },
                      "tanh-sinh quadrature over the light in 113 bits"},
                     absolute(kBound, kWhy)});
  }
  for (const auto& [name, size] : {std::pair("1e-3", 1e-3), std::pair("1e-6", 1e-6)}) {
    const PolygonSetting s{
        {{{.4, .3, 1}, {.4, .3 + size, 1}, {.4 + size, .3, 1}}}, {}, {0, 0, 1}, unit(.4, .3, 1)};
    add(cases, fmt::format("small-{}", name),
        fmt::format("a light of size {} in a lobe of exponent 100", name), s, 100,
        relative(kSmallBound / size, "documented bound of polygon_terms: 3e-15 / angular size"));
  }
}

}  // namespace lobe_cases

void add_lobe_cases(std::vector<Case>& cases) { lobe_cases::add(cases); }

}  // namespace penumbra::stress
