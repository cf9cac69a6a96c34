// The multi-level search of sum_search.h against a linear search.
#include "kernels/light/sum_search.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <vector>

#include "scenes/device/sum_levels.h"
#include "tests/kernels/random_numbers.h"

namespace penumbra {
namespace {

/// Two rows of sums with their levels, one after the other.
struct Rows {
  int count;
  std::vector<float> table;

  Rows(int sums, RandomNumbers& random) : count(sums) {
    for (int row = 0; row < 2; ++row) {
      const std::size_t start = table.size();
      float sum = 0;
      for (int k = 0; k < count; ++k) {
        table.push_back(sum);
        // Some are equal, some far apart.
        const float u = random.unit_float();
        sum += u < 0.3f ? 0.0f : (u > 0.999f ? 1e6f : u);
      }
      append_sum_levels(start, table);
    }
  }

  [[nodiscard]] float between(int k, float t) const {
    return mix_f(table[std::size_t(k)], table[table.size() / 2 + std::size_t(k)], t);
  }

  /// The greatest index up to `last` whose sum is at most the target, or 0.
  [[nodiscard]] int expected(float t, float target, int last) const {
    int found = 0;
    for (int k = 0; k <= last && between(k, t) <= target; ++k) found = k;
    return found;
  }
};

TEST(SumSearch, FindsWhatASearchThroughAllSumsFinds) {
  RandomNumbers random(7);
  for (const int count : {1, 2, 3, 15, 16, 17, 255, 256, 257, 272, 273, 4095, 4096, 4097, 32769}) {
    const Rows rows(count, random);
    const SearchLevels levels = search_levels(count);
    ASSERT_EQ(levels.size, int(rows.table.size() / 2)) << count;
    const int last = std::max(count - 2, 0);
    for (int turn = 0; turn < 100; ++turn) {
      int wanted[LANES], starts[LANES], found[LANES];
      float between[LANES], targets[LANES];
      for (int j = 0; j < LANES; ++j) {
        wanted[j] = random.unit_float() < 0.9f ? 1 : 0;
        starts[j] = 0;
        between[j] = turn % 4 == 0 ? 0.0f : random.unit_float();
        const float end = rows.between(count - 1, between[j]);
        // Between sums, exactly one of them, and none that there is.
        const int any = std::min(int(random.unit_float() * float(count)), count - 1);
        const float at[] = {random.unit_float() * end, rows.between(any, between[j]), end,
                            turn % 8 == 0 ? std::numeric_limits<float>::infinity() : -1.0f};
        targets[j] = at[(turn + j) % 4];
      }
      search_sums(rows.table.data(), levels, levels.size, last, wanted, starts, between, targets, found);
      for (int j = 0; j < LANES; ++j)
        ASSERT_EQ(found[j], wanted[j] != 0 ? rows.expected(between[j], targets[j], last) : 0)
            << count << " sums, " << targets[j] << " at " << between[j];
    }
  }
}

TEST(SumSearch, TargetsThatAreNoNumbersStayWithinTheSums) {
  RandomNumbers random(8);
  const Rows rows(300, random);
  const SearchLevels levels = search_levels(300);
  int wanted[LANES], starts[LANES], found[LANES];
  float between[LANES], targets[LANES];
  for (int j = 0; j < LANES; ++j) {
    wanted[j] = 1, starts[j] = 0, between[j] = 0.5f;
    targets[j] = std::numeric_limits<float>::quiet_NaN();
  }
  search_sums(rows.table.data(), levels, levels.size, 298, wanted, starts, between, targets, found);
  for (int j = 0; j < LANES; ++j) EXPECT_EQ(found[j], 0);
}

}  // namespace
}  // namespace penumbra
