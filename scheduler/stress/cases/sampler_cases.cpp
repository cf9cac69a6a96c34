// Samplers at the ends of their ranges.
#include <fmt/format.h>

#include "kernels/scene_types.h"
#include "scheduler/stress/cases/cases.h"
#include "scheduler/stress/cases/inputs.h"
#include "scheduler/stress/quantity_list.h"

namespace penumbra::stress {
namespace sampler_cases {
namespace {

constexpr double kMaxUint = 4294967295.0;
constexpr double kCount = 65536;

struct Sampler {
  const char* name;
  int kind;
};
constexpr Sampler kSamplers[] = {{"independent", SAMPLER_INDEPENDENT},
                                 {"stratified", SAMPLER_STRATIFIED},
                                 {"halton", SAMPLER_HALTON},
                                 {"sobol", SAMPLER_SOBOL}};

struct Range {
  const char *name, *stiff;
  double spp, seed, x, y, first, count;
};
constexpr Range kRanges[] = {
    {"seed-0", "seed 0, pixel 0", kCount, 0, 0, 0, 0, kCount},
    {"seed-max", "seed 2^32 - 1, pixel (32767, 32767)", kCount, kMaxUint, 32767, 32767, 0, kCount},
    {"index-max", "the last samples of 2^32 - 1", kMaxUint, 1, 5, 7, kMaxUint - 16, 16},
    {"prime", "a prime number of samples", 65521, 1, 5, 7, 0, 65521},
    {"one-sample", "one sample", 1, 1, 5, 7, 0, 1},
};

Numbers inputs(const Sampler& s, const Range& r, double pair) {
  return {double(s.kind), r.spp, r.seed, r.x, r.y, r.first, r.count, pair};
}

/// How far numbers are outside [0, 1 - 2^-24].
Numbers outside(const Numbers& out) {
  return {worst({0.0, -out[0], -out[2], out[1] - kBelow1, out[3] - kBelow1})};
}

}  // namespace

void add(std::vector<Case>& cases) {
  for (const Sampler& sampler : kSamplers) {
    for (const Range& range : kRanges)
      cases.push_back({fmt::format("sampler/{}-{}", sampler.name, range.name), range.stiff,
                       "how far any number is outside [0, 1 - 2^-24]",
                       KernelMeasurement{QUANTITY_SAMPLER, inputs(sampler, range, 2), outside},
                       known(0, "by definition"), absolute(0, "1 would be outside of everything")});
    for (const Range& range : {kRanges[0], kRanges[1]}) {
      // Variance 1/12 for independent numbers; of strata of one dimension, one in each, 1/12 / N^3 in sum.
      const bool spread = sampler.kind == SAMPLER_STRATIFIED || sampler.kind == SAMPLER_SOBOL;
      const bool halton = sampler.kind == SAMPLER_HALTON;
      const double deviation = std::sqrt(1.0 / 12 / kCount) * (spread ? 1 / std::sqrt(kCount) : 1);
      cases.push_back(
          {fmt::format("sampler/{}-{}-mean", sampler.name, range.name),
           range.stiff,
           "means of 65536 u and v",
           KernelMeasurement{QUANTITY_SAMPLER, inputs(sampler, range, 3), outputs(4, 2)},
           {[] {
              return Quads{Quad(1) / 2, Quad(1) / 2};
            },
            "by definition"},
           halton   ? absolute(17 / kCount, "discrepancy of Halton's: below log2(N) / N in a base")
           : spread ? absolute(5 * 256 * deviation + kUlp, "5 deviations of numbers in 256 strata each")
                    : absolute(5 * deviation, "5 standard deviations of N^-1/2")});
      if (spread)
        cases.push_back({fmt::format("sampler/{}-{}-strata", sampler.name, range.name), range.stiff,
                         "cells of 256 x 256 that 65536 samples hit",
                         KernelMeasurement{QUANTITY_SAMPLER, inputs(sampler, range, 3), outputs(6, 1)},
                         known(Quad(kCount), "by definition"), absolute(0, "one sample in each cell")});
    }
  }
  for (const double base : {2.0, 3.0, 53.0}) {
    cases.push_back({fmt::format("sampler/radical-inverse-{}", base),
                     "the last index, 2^32 - 1",
                     "radical inverse",
                     KernelMeasurement{QUANTITY_RADICAL_INVERSE, {kMaxUint, base}, {}},
                     {[base] {
                        Quad sum = 0, weight = 1;
                        for (auto i = std::uint64_t(kMaxUint); i > 0; i /= std::uint64_t(base)) {
                          weight /= base;
                          sum += weight * Quad(i % std::uint64_t(base));
                        }
                        return Quads{sum};
                      },
                      "digits in 113 bits"},
                     absolute(8 * kUlp, "roundings of a geometric series and of the digits' weights")});
  }
}

}  // namespace sampler_cases

void add_sampler_cases(std::vector<Case>& cases) { sampler_cases::add(cases); }

}  // namespace penumbra::stress
