// The merge of results into a film: 1e8 samples and more, unequal counts, every order.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "scheduler/stress/cases/cases.h"
#include "scheduler/stress/cases/inputs.h"

namespace penumbra::stress {
namespace merge_cases {
namespace {

constexpr double kEpsilon = 1.0 / (1ull << 53);  ///< relative rounding of a double

/// Statistics of one pixel in one unit, as a device sends them.
struct Block {
  std::uint32_t count;
  float mean, deviation;
};

std::uint32_t hash(std::uint32_t v) {
  v = (v ^ (v >> 16)) * 0x7feb352du;
  v = (v ^ (v >> 15)) * 0x846ca68bu;
  return v ^ (v >> 16);
}
double unit_number(std::uint32_t i) { return hash(i) / 4294967296.0; }

/// 24415 blocks of 4096 samples of Exp(1), plus an offset: means of 4096 have a deviation of 1/64.
std::vector<Block> exponential_blocks(double offset) {
  std::vector<Block> blocks;
  for (std::uint32_t i = 0; i < 24415; ++i) {
    double normal = -6;  // Irwin and Hall
    for (std::uint32_t k = 0; k < 12; ++k) normal += unit_number(12 * i + k);
    blocks.push_back({4096, float(offset + 1 + normal / 64), float(std::sqrt(.9 + .2 * unit_number(~i)))});
  }
  return blocks;
}

PixelStatistics merged(const std::vector<Block>& blocks) {
  FilmAccumulator film(0, 0, 1, 1, FilmLayers());
  SampleBuffer result;
  result.width = result.height = 1;
  result.values.resize(kRadiancePlanes);
  for (const Block& b : blocks) {
    result.sample_count = b.count;
    std::fill_n(result.values.begin() + kMeanR, 3, b.mean);
    std::fill_n(result.values.begin() + kDeviationR, 3, b.deviation);
    film.add(0, 0, result);
  }
  return film.at(0, 0);
}

struct Sums {
  Quad count = 0, mean = 0, m2 = 0, spread = 0;  ///< spread: of the blocks' means
};
Sums exact(const std::vector<Block>& blocks) {
  Sums s;
  for (const Block& b : blocks) {
    s.count += b.count;
    s.mean += Quad(b.count) * b.mean;
  }
  s.mean /= s.count;
  for (const Block& b : blocks) {
    s.spread += Quad(b.count) * (b.mean - s.mean) * (b.mean - s.mean);
    s.m2 += Quad(b.count) * b.deviation * b.deviation;
  }
  s.m2 += s.spread;
  return s;
}

struct Entry {
  const char *name, *stiff;
  std::function<std::vector<Block>()> blocks;
};

std::vector<Block> repeated(std::vector<Block> first, std::size_t times, const Block& block) {
  first.insert(first.end(), times, block);
  return first;
}

template <typename Order>
std::vector<Block> ordered(std::vector<Block> blocks, const Order& order) {
  order(blocks);
  return blocks;
}

const std::vector<Entry>& entries() {
  static const std::vector<Entry> list = {
      {"1e8", "1e8 samples of Exp(1)", [] { return exponential_blocks(0); }},
      {"1e8-backwards", "the same, last first",
       [] { return ordered(exponential_blocks(0), [](auto& b) { std::reverse(b.begin(), b.end()); }); }},
      {"1e8-sorted", "the same by rising mean",
       [] {
         return ordered(exponential_blocks(0), [](auto& b) {
           std::sort(b.begin(), b.end(), [](const Block& x, const Block& y) { return x.mean < y.mean; });
         });
       }},
      {"1e8-offset-1e8", "1e8 samples of Exp(1) + 1e8", [] { return exponential_blocks(1e8); }},
      {"1-then-1e8", "one sample, then 1e8 in one result",
       [] {
         return std::vector<Block>{{1, 7, 0}, {100'000'000, 1, 1}};
       }},
      {"1e8-then-1", "1e8 samples in one result, then one",
       [] {
         return std::vector<Block>{{100'000'000, 1, 1}, {1, 7, 0}};
       }},
      {"1e8-then-ones", "1e8 samples in one result, then 10000 single ones",
       [] {
         return repeated({{100'000'000, 1, 1}}, 10000, {1, 3, 0});
       }},
      {"single-samples", "1e6 results of one sample each",
       [] {
         std::vector<Block> blocks;
         for (std::uint32_t i = 0; i < 1'000'000; ++i)
           blocks.push_back({1, float(-std::log1p(-unit_number(i))), 0});
         return blocks;
       }},
      {"beyond-2^32", "a total above 2^32 samples",
       [] {
         return std::vector<Block>{{4'000'000'000u, 1, 1}, {4'000'000'000u, 2, 1}};
       }},
      {"radiance-1e-20", "means of 1e-20",
       [] {
         return std::vector<Block>{{4096, 1e-20f, 0}, {4096, 3e-20f, 0}, {4096, 2e-20f, 0}};
       }},
      {"radiance-1e30", "means of 1e30",
       [] {
         return std::vector<Block>{{4096, 1e30f, 0}, {4096, 3e30f, 0}, {4096, 2e30f, 0}};
       }},
      {"radiance-3e38", "means and deviations of 3e38, whose squares no float holds",
       [] {
         return std::vector<Block>{{4096, 1e38f, 3e38f}, {4096, 3e38f, 3e38f}, {4096, -2e38f, 3e38f}};
       }},
      {"spike", "one result of 1e8 among 1000 of 0",
       [] {
         return repeated({{4096, 0, 0}, {4096, 1e8f, 3.125e7f}}, 999, {4096, 0, 0});
       }},
  };
  return list;
}

}  // namespace

void add(std::vector<Case>& cases) {
  for (const Entry& e : entries()) {
    const auto make = e.blocks;
    // Each merge rounds the mean three times: by parts of the difference of the means, and of the mean.
    Allowed of_mean = absolute(0, "3 roundings of each merge, worst case");
    of_mean.computed = [make] {
      const std::vector<Block> blocks = make();
      double largest = 0;
      for (const Block& b : blocks) largest = std::max(largest, std::abs(double(b.mean)));
      return 3 * kEpsilon * double(blocks.size()) * largest;
    };
    cases.push_back({fmt::format("merge/{}-mean", e.name),
                     e.stiff,
                     "merged mean",
                     HostMeasurement{[make] { return Numbers{merged(make()).mean[0]}; }},
                     {[make] { return Quads{exact(make()).mean}; }, "sum in 113 bits"},
                     of_mean});
    Allowed of_m2 = absolute(0, "6 roundings of each merge, worst case, and the means' own");
    of_m2.computed = [make] {
      const std::vector<Block> blocks = make();
      const Sums s = exact(blocks);
      double largest = 0;
      for (const Block& b : blocks) largest = std::max(largest, std::abs(double(b.mean)));
      // A mean that is off by one rounding changes every difference by as much: to first order
      // 2 sqrt(count spread) of it.
      return 6 * kEpsilon * double(blocks.size()) * double(s.m2) +
             2 * kEpsilon * largest * double(blocks.size()) *
                 std::sqrt(double(s.spread * s.count) / double(blocks.size()));
    };
    cases.push_back({fmt::format("merge/{}-m2", e.name),
                     e.stiff,
                     "merged sum of squared deviations",
                     HostMeasurement{[make] { return Numbers{merged(make()).m2[0]}; }},
                     {[make] { return Quads{exact(make()).m2}; }, "sum in 113 bits"},
                     of_m2});
  }
}

}  // namespace merge_cases

void add_merge_cases(std::vector<Case>& cases) { merge_cases::add(cases); }

}  // namespace penumbra::stress
