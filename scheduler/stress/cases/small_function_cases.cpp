// Weights, statistics of a block, elementary functions and filters.
#include <fmt/format.h>

#include "kernels/scene_types.h"
#include "scheduler/stress/cases/cases.h"
#include "scheduler/stress/cases/inputs.h"
#include "scheduler/stress/quantity_list.h"

namespace penumbra::stress {
namespace small_function_cases {
namespace {

void add_weights(std::vector<Case>& cases) {
  struct Entry {
    const char *name, *stiff;
    double mine, other;
  };
  const Entry entries[] = {{"1e30-1e-30", "densities 60 orders apart", 1e30, 1e-30},
                           {"1e-30-1e30", "densities 60 orders apart", 1e-30, 1e30},
                           {"1e20-2e20", "densities whose squares overflow", 1e20, 2e20},
                           {"1e-30-2e-30", "densities whose squares underflow", 1e-30, 2e-30},
                           {"max", "the largest floats", 3.4e38, 3.4e38},
                           {"0-1", "no density of its own", 0, 1},
                           {"1-0", "no other density", 1, 0}};
  for (const Entry& e : entries) {
    for (const int heuristic : {HEURISTIC_BALANCE, HEURISTIC_POWER}) {
      const Numbers inputs = {double(heuristic), rounded(e.mine), rounded(e.other)};
      const auto weight = [inputs] {
        const Quad a = inputs[0] == HEURISTIC_POWER ? Quad(inputs[1]) * inputs[1] : Quad(inputs[1]);
        const Quad b = inputs[0] == HEURISTIC_POWER ? Quad(inputs[2]) * inputs[2] : Quad(inputs[2]);
        return Quads{a > 0 ? a / (a + b) : Quad(0)};
      };
      cases.push_back({fmt::format("mis/{}-{}", heuristic == HEURISTIC_POWER ? "power" : "balance", e.name),
                       e.stiff,
                       "weight",
                       KernelMeasurement{QUANTITY_MIS, inputs, {}},
                       {weight, "the definition in 113 bits"},
                       {1.2e-38, 4 * kUlp, "four roundings; below the smallest float 0", {}}});
    }
  }
}

void add_statistics(std::vector<Case>& cases) {
  struct Entry {
    const char *name, *stiff;
    double count, base, step, period;
  };
  const Entry entries[] = {
      {"constant", "4096 equal samples", 4096, .1, 0, 1},
      {"offset-1e8", "a spread of one rounding about 1e8", 4096, 1e8, 8, 2},
      {"spread-1e-20", "a radiance of 1e-20", 4096, 1e-20, 1e-20, 2},
      {"spread-1e20", "a radiance of 1e20", 4096, 1e20, 1e20, 2},
      {"spread-3e37", "a radiance of 3e37, of which 12 samples are no float", 4096, 3e37, 3e37, 2},
      {"largest", "samples next to the largest float", 4096, 3.2e38, 2e37, 2},
      {"spike", "one sample of 1e8 in 4096 of 1", 4096, 1, 0, 1},
      {"one", "one sample", 1, .3, 0, 1}};
  for (const Entry& e : entries) {
    const double base = rounded(e.base), step = rounded(e.step);
    const Numbers inputs = {e.count, base, step, e.period};
    const auto values = [=] {
      Quads all;
      for (int i = 0; i < int(e.count); ++i)
        all.push_back(rounded(base + rounded(step * (i % int(e.period)))));
      return all;
    };
    const auto mean = [=] {
      Quad sum = 0;
      for (const Quad& v : values()) sum += v;
      return sum / Quad(e.count);
    };
    cases.push_back({fmt::format("block/{}-mean", e.name),
                     e.stiff,
                     "mean of a block's samples",
                     KernelMeasurement{QUANTITY_ACCUMULATE, inputs, outputs(0, 1)},
                     {[mean] { return Quads{mean()}; }, "sum in 113 bits"},
                     relative(2 * kUlp, "the mean's own rounding, and that of the correction")});
    cases.push_back(
        {fmt::format("block/{}-deviation", e.name),
         e.stiff,
         "standard deviation of a block's samples",
         KernelMeasurement{
             QUANTITY_ACCUMULATE, inputs,
             [count = e.count](const Numbers& out) { return Numbers{std::sqrt(out[1] / count)}; }},
         {[=] {
            Quad squares = 0;
            const Quad m = mean();
            for (const Quad& v : values()) squares += (v - m) * (v - m);
            return Quads{sqrt_q(squares / Quad(e.count))};
          },
          "sum in 113 bits"},
         {kUlp * base, 4096 * kUlp, "the first estimate's rounding; a sum of 4096 squares in float", {}}});
  }
}

void add_functions(std::vector<Case>& cases) {
  struct Entry {
    const char* name;
    int function;
    double x, y;
    Quad (*truth)(Quad x, Quad y);
    double allowed;  ///< relative, documented in kernels/math/math.h
  };
  const auto exp = [](Quad x, Quad) { return exp_q(x); };
  const auto expm1 = [](Quad x, Quad) { return expm1_q(x); };
  const auto log = [](Quad x, Quad) { return log_q(x); };
  const auto log1p = [](Quad x, Quad) { return log1p_q(x); };
  const auto atan2 = [](Quad x, Quad y) { return atan2_q(y, x); };
  const Entry entries[] = {{"exp-87", MATH_EXP, -87.3, 0, exp, 2.6e-7},
                           {"exp+88", MATH_EXP, 88, 0, exp, 2.6e-7},
                           {"exp-1e-8", MATH_EXP, 1e-8, 0, exp, 2.6e-7},
                           {"expm1-1e-30", MATH_EXPM1, 1e-30, 0, expm1, 3e-7},
                           {"expm1-0.35", MATH_EXPM1, -.35, 0, expm1, 8e-7},
                           {"log-smallest", MATH_LOG, 1.2e-38, 0, log, 2.3e-7},
                           {"log-largest", MATH_LOG, 3.4e38, 0, log, 2.3e-7},
                           {"log-near-1", MATH_LOG, 1 - kUlp, 0, log, 2.3e-7},
                           {"log1p-1e-30", MATH_LOG1P, 1e-30, 0, log1p, 3e-7},
                           {"log1p-near--1", MATH_LOG1P, -1 + kUlp, 0, log1p, 3e-7},
                           {"atan2-1e-30", MATH_ATAN2, 1, 1e-30, atan2, 3e-7},
                           {"atan2-steep", MATH_ATAN2, 1e-30, 1, atan2, 3e-7},
                           {"atan2-behind", MATH_ATAN2, -1, 1e-20, atan2, 3e-7},
                           {"atan2-small", MATH_ATAN2, -1e-30, -1e-30, atan2, 3e-7}};
  for (const Entry& e : entries) {
    const double x = rounded(e.x), y = rounded(e.y);
    cases.push_back({fmt::format("math/{}", e.name),
                     "an end of the function's range",
                     "value",
                     KernelMeasurement{QUANTITY_MATH, {double(e.function), x, y}, {}},
                     {[=] { return Quads{e.truth(x, y)}; }, "the C library in 113 bits"},
                     relative(e.allowed, "documented in kernels/math/math.h")});
  }
  for (const auto& [name, u] : {std::pair("0", 0.0), std::pair("2", 2.0), std::pair("-2", -2.0),
                                std::pair("1/8", .125), std::pair("1-2^-24", kBelow1)}) {
    const double turns = u;
    for (const bool cosine : {false, true})
      cases.push_back(
          {fmt::format("math/{}-2pi-{}", cosine ? "cos" : "sin", name),
           "an end of an octant",
           "value",
           KernelMeasurement{QUANTITY_MATH, {double(cosine ? MATH_COS_2PI : MATH_SIN_2PI), turns, 0}, {}},
           {[=] {
              const Quad angle = 2 * kQuadPi * turns;
              return Quads{cosine ? cos_q(angle) : sin_q(angle)};
            },
            "the C library in 113 bits"},
           absolute(1.2e-7, "documented in kernels/math/math.h")});
  }
}

void add_filters(std::vector<Case>& cases) {
  for (const auto& [name, u] : {std::pair("u0", 0.0), std::pair("u1", kBelow1), std::pair("u-2^-24", kUlp),
                                std::pair("middle", .5)}) {
    const double number = u;
    for (const bool tent : {false, true})
      cases.push_back(
          {fmt::format("filter/{}-{}", tent ? "tent" : "box", name),
           fmt::format("u = {:.9g}", u),
           "offset in radii",
           KernelMeasurement{QUANTITY_FILTER, {double(tent ? FILTER_TENT : FILTER_BOX), number}, {}},
           {[=] {
              const Quad v = 2 * Quad(number) - 1;
              return Quads{tent ? (v < 0 ? -1 : 1) * (1 - sqrt_q(1 - abs_q(v))) : v};
            },
            "inverted distribution in 113 bits"},
           absolute(4 * kUlp, "four roundings of numbers up to 1")});
  }
}

}  // namespace

void add(std::vector<Case>& cases) {
  add_weights(cases);
  add_statistics(cases);
  add_functions(cases);
  add_filters(cases);
}

}  // namespace small_function_cases

void add_small_function_cases(std::vector<Case>& cases) { small_function_cases::add(cases); }

}  // namespace penumbra::stress
