// Properties of each sampler's points: range, purity, strata, nets, radical inverses.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>
#include <vector>

#include "tests/kernels/random_numbers.h"
#include "tests/kernels/sampler_points.h"

namespace penumbra {
namespace {

constexpr std::uint32_t kMax32 = 0xffffffffu;

class Sampler : public testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(All, Sampler, testing::ValuesIn(kSamplers),
                         [](const auto& tested) { return sampler_name(tested.param); });

TEST_P(Sampler, NumbersAreInTheHalfOpenUnitInterval) {
  const auto check = [](const SampleAddress& at, Point2 p) {
    ASSERT_TRUE(p.u >= 0 && p.u < 1 && p.v >= 0 && p.v < 1)
        << "seed " << at.seed << " pixel " << at.x << "," << at.y << " sample " << at.index << " pair "
        << at.pair << " of " << at.spp << ": " << p.u << ", " << p.v;
  };
  for (std::uint32_t seed : {0u, 1u, 0x7fffffffu, 0x80000000u, kMax32})
    for (std::uint32_t x : {0u, 1u, 32767u, kMax32})
      for (std::uint32_t index : {0u, 1u, 2u, 4095u, 0xffffffu, 0x1000000u, 99'999'999u, kMax32})
        for (std::uint32_t pair : {0u, 1u, 7u, 8u, 1000u})
          for (std::uint32_t spp : {1u, 2u, 3u, 7u, 16u, 4096u, 100'000'000u, kMax32}) {
            const SampleAddress at{seed, x, x / 2, index, pair, spp};
            check(at, draw(GetParam(), at));
          }
  RandomNumbers random(2);
  for (int i = 0; i < 1'000'000; ++i) {
    const SampleAddress at{.seed = std::uint32_t(random.next()),
                           .index = std::uint32_t(random.next()) >> random.below(32),
                           .pair = std::uint32_t(random.below(20)),
                           .spp = 1 + std::uint32_t(random.below(1000))};
    check(at, draw_alone(GetParam(), at));
  }
}

TEST_P(Sampler, IsAPureFunctionOfItsArguments) {
  RandomNumbers random(3);
  for (int i = 0; i < 1000; ++i) {
    const SampleAddress at{std::uint32_t(random.next()),      std::uint32_t(random.below(4000)),
                           std::uint32_t(random.below(4000)), std::uint32_t(random.below(64)),
                           std::uint32_t(random.below(30)),   64};
    const Point2 first = draw(GetParam(), at), again = draw(GetParam(), at),
                 alone = draw_alone(GetParam(), at);
    ASSERT_EQ(first.u, again.u);
    ASSERT_EQ(first.v, again.v);
    ASSERT_EQ(first.u, alone.u);
    ASSERT_EQ(first.v, alone.v);
  }
}

TEST_P(Sampler, LanesAndBlocksDoNotMatter) {
  constexpr int kCapacity = 5 * LANES;
  BlockMemory memory(FEATURE_ALL, kCapacity, 0);
  const PathState paths = memory.block().paths;
  for (int i = 0; i < kCapacity; ++i) {
    set_pixel_hash(&paths, i, int(pixel_sequence(GetParam(), 5, uint(i) % 7, uint(i) / 7)));
    set_sample_index(&paths, i, i * 3 % 16);
  }
  for (int first = 0; first < kCapacity; first += LANES) {
    float u[LANES], v[LANES];
    sample_pair(GetParam(), 16, one_point(3), &paths, first, u, v);
    for (int j = 0; j < LANES; ++j) {
      const auto i = std::uint32_t(first + j);
      const Point2 alone = draw_alone(GetParam(), {5, i % 7, i / 7, i * 3 % 16, 3, 16});
      EXPECT_EQ(u[j], alone.u);
      EXPECT_EQ(v[j], alone.v);
    }
  }
}

TEST_P(Sampler, SeveralPointsOfASampleAreOneSequence) {
  constexpr int kTimes = 5, kSpp = 16;
  BlockMemory memory(FEATURE_ALL, LANES, 0);
  const PathState paths = memory.block().paths;
  for (int j = 0; j < LANES; ++j) {
    set_pixel_hash(&paths, j, int(pixel_sequence(GetParam(), 5, 1, 2)));
    set_sample_index(&paths, j, j % kSpp);
  }
  for (int nth = 0; nth < kTimes; ++nth) {
    float u[LANES], v[LANES];
    sample_pair(GetParam(), kSpp, nth_point(one_point(3), kTimes, nth), &paths, 0, u, v);
    for (int j = 0; j < LANES; ++j) {
      const auto index = std::uint32_t(j % kSpp * kTimes + nth);
      const Point2 alone = draw_alone(GetParam(), {5, 1, 2, index, 3, kTimes * kSpp});
      EXPECT_EQ(u[j], alone.u);
      EXPECT_EQ(v[j], alone.v);
    }
  }
}

TEST_P(Sampler, EveryPartOfTheAddressMatters) {
  const SampleAddress base{.seed = 7, .x = 3, .y = 9, .index = 5, .pair = 2, .spp = 16};
  std::vector<SampleAddress> others(6, base);
  others[0].seed = 8;
  others[1].x = 4;
  others[2].y = 10;
  others[3].index = 6;
  others[4].pair = 3;
  std::swap(others[5].x, others[5].y);
  const Point2 p = draw(GetParam(), base);
  for (std::size_t i = 0; i < others.size(); ++i) {
    const Point2 q = draw(GetParam(), others[i]);
    EXPECT_NE(p.u, q.u) << i;
    EXPECT_NE(p.v, q.v) << i;
  }
}

TEST(SamplerBits, ReversedBits) {
  EXPECT_EQ(reverse_bits(1u), 0x80000000u);
  EXPECT_EQ(reverse_bits(0x00f0000au), 0x50000f00u);
  RandomNumbers random(4);
  for (int i = 0; i < 1000; ++i) {
    const auto v = std::uint32_t(random.next());
    std::uint32_t expected = 0;
    for (int k = 0; k < 32; ++k) expected |= ((v >> k) & 1u) << (31 - k);
    ASSERT_EQ(reverse_bits(v), expected);
  }
}

TEST(SamplerBits, SecondSobolDimensionIsPascalsMatrix) {
  // Bit row r of the point is the sum modulo 2 of the index's bits c with odd binomial(c, r); binomial(c, r)
  // is odd exactly if r's bits are among c's (Lucas).
  RandomNumbers random(5);
  for (int i = 0; i < 1000; ++i) {
    const auto index = std::uint32_t(random.next());
    std::uint32_t expected = 0;
    for (std::uint32_t row = 0; row < 32; ++row) {
      std::uint32_t bit = 0;
      for (std::uint32_t column = 0; column < 32; ++column)
        if ((row & column) == row) bit ^= (index >> column) & 1u;
      expected |= bit << row;
    }
    ASSERT_EQ(sobol_second_reversed(index), expected) << index;
  }
}

TEST(SamplerBits, UnitFloatKeepsTheTopBits) {
  EXPECT_EQ(unit_float(0), 0.0f);
  EXPECT_EQ(unit_float(255), 0.0f);
  EXPECT_EQ(unit_float(256), 0x1p-24f);
  EXPECT_EQ(unit_float(kMax32), ONE_MINUS_EPSILON);
}

/// Whether no two points are in one elementary interval of area 2^-m: 2^m such points are a (0, m, 2)-net.
bool is_net(const std::vector<Point2>& points, int m) {
  for (int a = 0; a <= m; ++a) {
    std::vector<bool> taken(std::size_t(1) << m);
    for (const Point2& p : points) {
      const auto column = std::size_t(std::ldexp(p.u, a)), row = std::size_t(std::ldexp(p.v, m - a));
      const std::size_t cell = (row << a) + column;
      if (taken[cell]) return false;
      taken[cell] = true;
    }
  }
  return true;
}

TEST(SobolSampler, BlocksOfTwoToTheMAreNets) {
  for (std::uint32_t seed : {0u, 42u, kMax32})
    for (std::uint32_t pair : {0u, 1u, 5u, 400u})
      for (int m = 0; m <= 12; ++m)
        for (std::uint32_t block : {0u, 1u, 6u}) {
          std::vector<Point2> points;
          for (std::uint32_t i = 0; i < (1u << m); ++i)
            points.push_back(draw_alone(SAMPLER_SOBOL, {seed, 12, 34, (block << m) + i, pair, 8u << m}));
          ASSERT_TRUE(is_net(points, m))
              << "m " << m << " pair " << pair << " seed " << seed << " block " << block;
        }
}

/// Points `first` ... of the pixels of a rectangle whose lowest pixel is x, y.
std::vector<Point2> points_of(SampleAddress at, int width, int height, std::uint32_t first,
                              std::uint32_t count) {
  std::vector<Point2> points;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      for (std::uint32_t i = first; i < first + count; ++i) {
        SampleAddress of_pixel = at;
        of_pixel.x += std::uint32_t(x);
        of_pixel.y += std::uint32_t(y);
        of_pixel.index = i;
        points.push_back(draw_alone(SAMPLER_SOBOL, of_pixel));
      }
  return points;
}

TEST(SobolSampler, AlignedSquaresOfPixelsAreNets) {
  for (std::uint32_t seed : {0u, 42u, kMax32})
    for (std::uint32_t pair : {0u, 1u, 5u, 400u})
      for (int level = 0; level <= TILE_LEVELS; ++level)
        for (int bits = 0; 2 * level + bits <= 10; ++bits)
          for (std::uint32_t place : {0u, 3u, 8u}) {
            const int side = 1 << level;
            const SampleAddress corner{.seed = seed,
                                       .x = 160 + place * std::uint32_t(side),
                                       .y = 32 + 5 * std::uint32_t(side),
                                       .pair = pair,
                                       .spp = 1u << bits};
            ASSERT_TRUE(is_net(points_of(corner, side, side, 0, corner.spp), 2 * level + bits))
                << side << " pixels, spp " << corner.spp << " pair " << pair << " seed " << seed;
            if (level == TILE_LEVELS) continue;
            // Two such squares side by side, where the Z curve passes from one to the other.
            SampleAddress two = corner;
            two.x = 160 + (place & ~1u) * std::uint32_t(side);
            ASSERT_TRUE(is_net(points_of(two, 2 * side, side, 0, two.spp), 2 * level + 1 + bits))
                << side << " pixels, spp " << corner.spp << " pair " << pair << " seed " << seed;
          }
}

TEST(SobolSampler, SamplesOfSeveralPointsAndPassesAreNets) {
  // Samples that take 4 points each; a later pass has the second half of the samples, of which each pixel's
  // are a net.
  for (std::uint32_t pair : {0u, 3u}) {
    const SampleAddress corner{.seed = 3, .x = 68, .y = 44, .pair = pair, .spp = 8 * 4};
    EXPECT_TRUE(is_net(points_of(corner, 4, 4, 0, 32), 9));
    EXPECT_TRUE(is_net(points_of(corner, 1, 1, 16, 16), 4));
  }
}

TEST(SobolSampler, SquaresAcrossTilesAreNoNets) {
  int nets = 0;
  for (std::uint32_t pair = 0; pair < 8; ++pair) {
    const SampleAddress corner{.seed = 3, .x = 14, .y = 14, .pair = pair, .spp = 4};
    nets += is_net(points_of(corner, 4, 4, 0, 4), 6) ? 1 : 0;
  }
  EXPECT_EQ(nets, 0);
}

TEST(SobolSampler, OtherCountsArePartsOfNets) {
  // Of a pixel and of every aligned square, for the next power of two.
  for (std::uint32_t spp : {3u, 5u, 6u, 7u, 12u, 100u}) {
    const int bits = int(std::ceil(std::log2(spp)));
    for (std::uint32_t pair : {0u, 2u, 9u})
      for (int level = 0; level <= 2; ++level) {
        const SampleAddress corner{.seed = 8, .x = 52, .y = 20, .pair = pair, .spp = spp};
        ASSERT_TRUE(is_net(points_of(corner, 1 << level, 1 << level, 0, spp), 2 * level + bits)) << spp;
      }
  }
}

TEST(SobolSampler, MorePointsThan32BitsNumber) {
  // Up to 2^24 points of a pixel its place fits above them; beyond, each pixel has a sequence of its own.
  for (std::uint32_t spp : {(1u << 24) - 1u, 1u << 24, (1u << 24) + 1u, 100'000'000u, kMax32}) {
    std::set<float> us;
    for (std::uint32_t y = 0; y < 16; ++y)
      for (std::uint32_t x = 0; x < 16; ++x) us.insert(draw_alone(SAMPLER_SOBOL, {1, x, y, 5, 1, spp}).u);
    // Of 256 numbers with 24 digits two are equal with a chance of 256^2 / 2^25 = 0.002.
    EXPECT_EQ(us.size(), 256u) << spp;
    for (std::uint32_t first : {0u, (spp >> 12) - 1u})
      EXPECT_TRUE(is_net(points_of({.seed = 1, .x = 3, .y = 2, .spp = spp}, 1, 1, first << 10, 1024), 10))
          << spp;
  }
}

TEST(SamplerBits, PointsOfAPixelNeedSoManyDigits) {
  for (const auto& [points, bits] : std::vector<std::pair<std::uint32_t, std::uint32_t>>{{1, 0},
                                                                                         {2, 1},
                                                                                         {3, 2},
                                                                                         {4, 2},
                                                                                         {5, 3},
                                                                                         {1u << 24, 24},
                                                                                         {(1u << 24) + 1, 25},
                                                                                         {1u << 31, 31},
                                                                                         {(1u << 31) + 1, 32},
                                                                                         {kMax32, 32}})
    EXPECT_EQ(point_bits(points), bits) << points;
}

TEST(SamplerBits, MortonIndexInterleavesDigits) {
  for (std::uint32_t x = 0; x < 256; ++x)
    for (std::uint32_t y = 0; y < 256; ++y) {
      std::uint32_t expected = 0;
      for (int k = 0; k < 8; ++k) expected |= ((x >> k & 1u) << 2 * k) | ((y >> k & 1u) << (2 * k + 1));
      ASSERT_EQ(morton_index(x, y), expected);
    }
}

TEST(SamplerBits, OnlySobolSharesSequences) {
  for (int sampler : kSamplers)
    for (std::uint32_t x : {0u, 5u, 16u, 1u << 20}) {
      const std::uint32_t pixel = pixel_sequence(sampler, 7, x, 21), hash = pixel_hash(7, x, 21);
      const std::uint32_t in_tile = (pixel_hash(7, x / 16, 1) & ~255u) | morton_index(x % 16, 5);
      EXPECT_EQ(pixel, sampler == SAMPLER_SOBOL ? in_tile : hash);
    }
}

TEST(SobolSampler, IndependentPointsAreNoNet) {
  std::vector<Point2> points;
  for (std::uint32_t i = 0; i < 64; ++i)
    points.push_back(draw_alone(SAMPLER_INDEPENDENT, {1, 2, 3, i, 0, 64}));
  EXPECT_FALSE(is_net(points, 6));
}

TEST(StratifiedSampler, PermutesItsStrata) {
  for (std::uint32_t n : {1u, 2u, 3u, 5u, 16u, 31u, 33u, 100u, 1000u})
    for (std::uint32_t seed : {0u, 1u, 12345u, 0x80000000u, kMax32 - 500u, kMax32 - 3u, kMax32}) {
      std::set<std::uint32_t> values;
      for (std::uint32_t i = 0; i < n; ++i) {
        const std::uint32_t value = permute(i, n, seed);
        ASSERT_LT(value, n);
        values.insert(value);
      }
      EXPECT_EQ(values.size(), n) << "seed " << seed;
    }
}

TEST(StratifiedSampler, HasOnePointInEveryStratum) {
  for (std::uint32_t spp : {1u, 2u, 3u, 4u, 6u, 12u, 16u, 17u, 64u, 100u, 256u, 1000u}) {
    const std::uint32_t columns = strata_columns(spp), rows = spp / columns;
    ASSERT_EQ(columns * rows, spp);
    for (std::uint32_t x = 0; x < 20; ++x)
      for (std::uint32_t pair : {0u, 3u}) {
        std::vector<int> count(spp);
        for (std::uint32_t i = 0; i < spp; ++i) {
          const Point2 p = draw_alone(SAMPLER_STRATIFIED, {9, x, 0, i, pair, spp});
          ++count[std::size_t(p.v * float(rows)) * columns + std::size_t(p.u * float(columns))];
        }
        EXPECT_EQ(std::ranges::count(count, 1), spp) << "of " << spp << " at pixel " << x;
      }
  }
}

TEST(StratifiedSampler, GridIsAsSquareAsTheCountAllows) {
  EXPECT_EQ(strata_columns(1), 1u);
  EXPECT_EQ(strata_columns(12), 3u);
  EXPECT_EQ(strata_columns(16), 4u);
  EXPECT_EQ(strata_columns(17), 1u);
  EXPECT_EQ(strata_columns(4096), 64u);
  EXPECT_EQ(strata_columns(16'777'216), 4096u);
}

TEST_P(Sampler, StepsUseDisjointPairsByTheDepthOfThePath) {
  constexpr int kPairs = STEP_PAIRS;
  BlockMemory memory(FEATURE_ALL, LANES, 0);
  const PathState paths = memory.block().paths;
  for (int j = 0; j < LANES; ++j) {
    set_pixel_hash(&paths, j, int(pixel_sequence(GetParam(), 5, 1, 2)));
    set_sample_index(&paths, j, 7);
    set_depth(&paths, j, j);
  }
  std::set<uint> pairs{0};  // the film's
  for (int pair = 0; pair < kPairs; ++pair) {
    float u[LANES], v[LANES];
    sample_pair(GetParam(), 16, step_point(uint(pair)), &paths, 0, u, v);
    for (int j = 0; j < LANES; ++j) {
      const uint of_path = pair_of_path(step_point(uint(pair)), &paths, j);
      EXPECT_EQ(of_path, uint(1 + j * kPairs + pair));
      EXPECT_TRUE(pairs.insert(of_path).second);
      const Point2 alone = draw_alone(GetParam(), {5, 1, 2, 7, of_path, 16});
      EXPECT_EQ(u[j], alone.u);
      EXPECT_EQ(v[j], alone.v);
    }
  }
}

}  // namespace
}  // namespace penumbra
