// Search in cumulative sums with coarser levels: each level holds every 16th number of the level below. A
// search reads one group of 16 neighbours, a cache line, at each level, and compares all of them at once. In
// a binary search every step would wait for another cache line.
//
// Layout: the sums, then further levels until one has 16 numbers or fewer. Each level is padded to a multiple
// of 16 with numbers above all sums.
#ifndef PENUMBRA_SUM_SEARCH_H
#define PENUMBRA_SUM_SEARCH_H
#include "kernels/math/math.h"

PENUMBRA_NAMESPACE_BEGIN

#define SEARCH_BRANCHES 16
#define SEARCH_LEVELS 4  // enough for 16^4 sums

typedef struct {
  int count[SEARCH_LEVELS];  ///< numbers in each level, finest first
  int start[SEARCH_LEVELS];  ///< offset of each level
  int levels;                ///< number of levels
  int size;                  ///< words of all levels
} SearchLevels;

FN int search_padded(int count) { return (count + SEARCH_BRANCHES - 1) / SEARCH_BRANCHES * SEARCH_BRANCHES; }

/// The levels for `count` sums, 1 to 16^4.
FN SearchLevels search_levels(int count) {
  SearchLevels of;
  of.levels = of.size = 0;
  UNROLL
  for (int k = 0; k < SEARCH_LEVELS; k++) {
    const bool there = (k == 0) | (of.count[k > 0 ? k - 1 : 0] > SEARCH_BRANCHES);
    of.count[k] = there ? (k == 0 ? count : search_padded(of.count[k > 0 ? k - 1 : 0]) / SEARCH_BRANCHES) : 0;
    of.start[k] = of.size;
    of.levels += there ? 1 : 0;
    of.size += search_padded(of.count[k]);
  }
  return of;
}

/// The words that the levels of `count` sums take.
FN int search_size(int count) { return search_levels(count).size; }

/// How many of 16 numbers, interpolated between two groups, are at most `target`.
FN int count_at_most(GLOBAL const float* first, GLOBAL const float* second, float t, float target) {
  int below = 0;
  REGISTER_LOOP(SEARCH_BRANCHES)
  for (int k = 0; k < SEARCH_BRANCHES; k++) below += mix_f(first[k], second[k], t) <= target ? 1 : 0;
  return below;
}

/// For each `wanted` lane: searches the sums interpolated between two rows of `table`, which start at rows[j]
/// and at rows[j] + next_row. The result is the largest index up to `last` whose sum is at most targets[j],
/// or 0. Other lanes get 0.
STAGE void search_sums(GLOBAL const float* table, SearchLevels levels, int next_row, int last,
                       const PRIVATE int* RESTRICT wanted, const PRIVATE int* RESTRICT rows,
                       const PRIVATE float* RESTRICT between, const PRIVATE float* RESTRICT targets,
                       PRIVATE int* RESTRICT found) {
  for (int j = 0; j < LANES; j++) found[j] = 0;
  for (int k = levels.levels - 1; k >= 0; k--) {
    const int greatest = levels.count[k] - 1;
    for (int j = 0; j < LANES; j++) {  // no lane loop: lanes do not wait for each other's cache lines
      if (wanted[j] == 0) continue;
      GLOBAL const float* group = table + rows[j] + levels.start[k] + SEARCH_BRANCHES * found[j];
      const int below = count_at_most(group, group + next_row, between[j], targets[j]);
      found[j] = min_i(SEARCH_BRANCHES * found[j] + (below > 0 ? below - 1 : 0), greatest);
    }
  }
  for (int j = 0; j < LANES; j++) found[j] = min_i(found[j], last);
}

PENUMBRA_NAMESPACE_END
#endif
