// Compaction: remaining paths move to the first lanes with all fields that move, finished paths write their
// samples.
#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <string>
#include <vector>

#include "tests/kernels/block/path_values.h"
#include "tests/kernels/random_numbers.h"
#include "tests/kernels/scene_tables.h"

namespace penumbra {
namespace {

constexpr int kCapacity = 5 * LANES, kSlots = 2 * kCapacity;

/// A block of paths in random slots, of which each goes on with a probability.
struct Compacted {
  Compacted(std::uint32_t mask, int path_count, double probability, RandomNumbers& random)
      : features(mask), count(path_count), memory(mask, kCapacity, kSlots) {
    tables.header.features = mask;
    const Block block = memory.block();
    paths = block.paths;
    slots = block.slots;
    std::vector<int> places(kSlots);
    std::iota(places.begin(), places.end(), 0);
    for (int i = 0; i < kSlots; ++i) {
      std::swap(places[std::size_t(i)], places[random.below(kSlots)]);
      fill_slot(features, slots, i);
    }
    slot_of.assign(places.begin(), places.begin() + kCapacity);
    for (int i = 0; i < kCapacity; ++i) {
      fill_path(features, paths, i);
      set_slot(&paths, i, slot_of[std::size_t(i)]);
      const bool alive = random.uniform() < probability;
      set_alive(&paths, i, alive);
      if (alive && i < count) going.push_back(i);
    }
    const Scene scene = tables.scene();
    left = compact(&scene, &paths, count, EVERY_CHANNEL, &slots);
  }

  /// That the lane holds everything that travels of what was lane `from`.
  void expect_lane(int lane, int from) const {
    int field = 0;
#define CHECK_FIELD(type, name, needs, travels)                                                   \
  if (is_moved(features, needs, travels) && std::string(#name) != "slot") {                       \
    ASSERT_TRUE(same(get_##name(&paths, lane), value_of<type>(field, from)))                      \
        << #name " of lane " << lane << ", which was " << from << ", with features " << features; \
  }                                                                                               \
  ++field;
    PATH_FIELDS(CHECK_FIELD)
#undef CHECK_FIELD
    ASSERT_EQ(get_slot(&paths, lane), slot_of[std::size_t(from)]);
  }

  std::uint64_t features;
  int count;
  SceneTables tables;
  BlockMemory memory;
  PathState paths{};
  SlotState slots{};
  std::vector<int> slot_of, going;
  int left = 0;
};

constexpr std::uint64_t kMasks[] = {FEATURE_PATH,
                                    FEATURE_PATH | FEATURE_PROJECTED | FEATURE_LAYERS,
                                    FEATURE_DIRECT,
                                    FEATURE_DIRECT | FEATURE_UV,
                                    FEATURE_PATH | FEATURE_POLYGONS,
                                    FEATURE_DIRECT | FEATURE_POLYGONS | FEATURE_LAYERS,
                                    FEATURE_WHITTED | FEATURE_TRANSMISSION,
                                    FEATURE_ALL};

template <typename Check>
void for_random_blocks(Check check) {
  RandomNumbers random(1);
  for (const std::uint64_t features : kMasks)
    for (const double probability : {0.0, 0.1, 0.5, 0.9, 1.0})
      for (int k = 0; k < 20 && !testing::Test::HasFatalFailure(); ++k)
        check(Compacted(features, 1 + int(random.below(kCapacity)), probability, random));
}

TEST(Compaction, PathsThatGoOnMoveUpInOrderWithAllThatTravels) {
  for_random_blocks([](const Compacted& c) {
    ASSERT_EQ(c.left, int(c.going.size()));
    for (int m = 0; m < c.left; ++m) c.expect_lane(m, c.going[std::size_t(m)]);
  });
}

TEST(Compaction, FinishedPathsLeaveTheirSamplesInTheirSlots) {
  int radiance = -1, shadowed = -1, unshadowed = -1, analytic = -1, field = 0;
#define FIND_FIELD(type, name, needs, travels)                \
  if (std::string(#name) == "radiance") radiance = field;     \
  if (std::string(#name) == "shadowed") shadowed = field;     \
  if (std::string(#name) == "unshadowed") unshadowed = field; \
  if (std::string(#name) == "analytic") analytic = field;     \
  ++field;
  PATH_FIELDS(FIND_FIELD)
#undef FIND_FIELD
  for_random_blocks([&](const Compacted& c) {
    std::vector<int> path_of(kSlots, -1);  // that finished there
    for (int i = 0; i < c.count; ++i)
      if (!std::ranges::binary_search(c.going, i)) path_of[std::size_t(c.slot_of[std::size_t(i)])] = i;
    for (int slot = 0; slot < kSlots; ++slot) {
      const int path = path_of[std::size_t(slot)];
      int number = 100;
      // Everything else of a slot, and every other slot, stays.
#define CHECK_FIELD(type, name, needs, travels)                                                          \
  {                                                                                                      \
    const std::string field_name = #name;                                                                \
    const int from = field_name == "sample"       ? radiance                                             \
                     : field_name == "shadowed"   ? shadowed                                             \
                     : field_name == "unshadowed" ? unshadowed                                           \
                     : field_name == "analytic"   ? analytic                                             \
                                                  : -1;                                                    \
    const type expected =                                                                                \
        path >= 0 && from >= 0 ? value_of<type>(from, path) : value_of<type>(number, slot);              \
    if (is_stored(c.features, needs)) {                                                                  \
      ASSERT_TRUE(same(get_slot_##name(&c.slots, slot), expected)) << field_name << " of slot " << slot; \
    }                                                                                                    \
    ++number;                                                                                            \
  }
      SLOT_FIELDS(CHECK_FIELD)
#undef CHECK_FIELD
    }
  });
}

// Channels are traced one after the other, from FIRST_CHANNEL on; a contradiction that one of them has found
// belongs to the sample. What was in the slot before does not.
TEST(Compaction, ContradictionsOfAllChannelsAreOfTheSample) {
  BlockMemory memory(FEATURE_ALL, kCapacity, kSlots);
  const Block block = memory.block();
  set_slot(&block.paths, 0, 3);
  for (int with = 0; with < 3; ++with) {
    set_slot_contradiction(&block.slots, 3, 77);
    for (int turn = 0; turn < 3; ++turn) {
      const int channel = (turn + FIRST_CHANNEL) % 3;
      set_contradiction(&block.paths, 0, channel == with ? 5 : 0);
      finish_crossings(&block.paths, 0, channel, &block.slots);
    }
    EXPECT_EQ(get_slot_contradiction(&block.slots, 3), 5) << "by channel " << with;
  }
}

TEST(Compaction, LanesPastTheLastPathRepeatIt) {
  for_random_blocks([](const Compacted& c) {
    if (c.left == 0) return;
    pad_lanes(c.features, &c.paths, c.left);
    for (int m = 0; m < (c.left + LANES - 1) / LANES * LANES; ++m)
      c.expect_lane(m, c.going[std::size_t(std::min(m, c.left - 1))]);
  });
}

}  // namespace
}  // namespace penumbra
