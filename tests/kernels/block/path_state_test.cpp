// The state of paths: which fields have storage, that storage does not overlap, and that values are read as
// written.
#include <gtest/gtest.h>

#include <algorithm>
#include <ostream>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "tests/kernels/block/path_values.h"
#include "tests/kernels/random_numbers.h"

namespace penumbra::path_state_test {
namespace {

constexpr int kCapacity = 3 * LANES, kSlots = 77;

struct NamedMask {
  std::string name;
  std::uint64_t features;
};
void PrintTo(const NamedMask& mask, std::ostream* out) { *out << mask.name; }

const NamedMask kMasks[] = {
    {"Path", FEATURE_PATH},
    {"PathWithLayers", FEATURE_PATH | FEATURE_LAYERS},
    {"PathByProjectedSolidAngle", FEATURE_PATH | FEATURE_PROJECTED | FEATURE_BVH},
    {"Direct", FEATURE_DIRECT},
    {"DirectWithUv", FEATURE_DIRECT | FEATURE_UV},
    {"PathWithUv", FEATURE_PATH | FEATURE_UV},
    {"DirectWithPolygons", FEATURE_DIRECT | FEATURE_POLYGONS},
    {"PathWithPolygonsAndLayers", FEATURE_PATH | FEATURE_POLYGONS | FEATURE_PROJECTED | FEATURE_LAYERS},
    {"Whitted", FEATURE_WHITTED},
    {"Occlusion", FEATURE_OCCLUSION | FEATURE_LAYERS},
    {"NoIntegrator", FEATURE_QUADRICS | FEATURE_MIXED_FAMILIES},
    {"All", FEATURE_ALL}};

template <typename Value>
constexpr int kWords = std::is_same_v<Value, vec3> ? 3 : 1;

struct Field {
  std::string name;
  bool stored;
  const void* start;
  int words;
};

std::vector<Field> path_fields(std::uint64_t features, const PathState& paths) {
  std::vector<Field> fields;
#define LIST_FIELD(type, name, needs, travels) \
  fields.push_back({#name, is_stored(features, needs), paths.name, kWords<type>});
  PATH_FIELDS(LIST_FIELD)
#undef LIST_FIELD
#define LIST_FIELD(type, name, needs, travels) \
  fields.push_back({#name, is_stored(features, needs), paths.name, MAX_BRANCH_DEPTH * kWords<type>});
  STACKED_FIELDS(LIST_FIELD)
#undef LIST_FIELD
  return fields;
}
std::vector<Field> slot_fields(std::uint64_t features, const SlotState& slots) {
  std::vector<Field> fields;
#define LIST_FIELD(type, name, needs, travels) \
  fields.push_back({#name, is_stored(features, needs), slots.name, kWords<type>});
  SLOT_FIELDS(LIST_FIELD)
#undef LIST_FIELD
  return fields;
}

class PathStates : public testing::TestWithParam<NamedMask> {
 protected:
  std::uint64_t features_ = GetParam().features;
};
INSTANTIATE_TEST_SUITE_P(All, PathStates, testing::ValuesIn(kMasks),
                         [](const auto& tested) { return tested.param.name; });

/// Fields with storage lie side by side from the first word to the last, and overlap nowhere.
void expect_tiled(const std::vector<Field>& fields, const std::vector<uint>& memory, int words,
                  int capacity) {
  int sum = 0;
  std::vector<std::pair<std::ptrdiff_t, std::ptrdiff_t>> places;
  for (const Field& field : fields) {
    if (!field.stored) continue;
    const std::ptrdiff_t first = static_cast<const uint*>(field.start) - memory.data();
    places.emplace_back(first, first + field.words * capacity);
    sum += field.words;
  }
  EXPECT_EQ(words, sum);
  std::ranges::sort(places);
  std::ptrdiff_t end = 0;
  for (const auto& [first, last] : places) {
    EXPECT_EQ(first, end);
    end = last;
  }
  EXPECT_EQ(end, std::ptrdiff_t(memory.size()));
}

TEST_P(PathStates, FieldsThatAreNeededFillTheMemoryAndDoNotOverlap) {
  std::vector<uint> path_memory(std::size_t(path_words(features_) * kCapacity));
  std::vector<uint> slot_memory(std::size_t(slot_words(features_) * kSlots));
  const Block block = make_block(features_, path_memory.data(), kCapacity, slot_memory.data(), kSlots);
  EXPECT_EQ(block.paths.capacity, kCapacity);
  EXPECT_EQ(block.slots.capacity, kSlots);
  expect_tiled(path_fields(features_, block.paths), path_memory, path_words(features_), kCapacity);
  expect_tiled(slot_fields(features_, block.slots), slot_memory, slot_words(features_), kSlots);
}

TEST_P(PathStates, WhatIsSetIsGotFromEachFieldAndLane) {
  BlockMemory memory(features_, kCapacity, kSlots);
  const Block block = memory.block();
  for (int i = 0; i < kCapacity; ++i) fill_path(features_, block.paths, i);
  for (int i = 0; i < kSlots; ++i) fill_slot(features_, block.slots, i);
  for (int i = 0; i < kCapacity; ++i) {
    int field = 0;
#define CHECK_FIELD(type, name, needs, travels)                                                 \
  if (is_stored(features_, needs)) {                                                            \
    EXPECT_TRUE(same(get_##name(&block.paths, i), value_of<type>(field, i))) << #name " " << i; \
  }                                                                                             \
  ++field;
    PATH_FIELDS(CHECK_FIELD)
#undef CHECK_FIELD
  }
  for (int i = 0; i < kSlots; ++i) {
    int field = 100;
#define CHECK_FIELD(type, name, needs, travels)                                                      \
  if (is_stored(features_, needs)) {                                                                 \
    EXPECT_TRUE(same(get_slot_##name(&block.slots, i), value_of<type>(field, i))) << #name " " << i; \
  }                                                                                                  \
  ++field;
    SLOT_FIELDS(CHECK_FIELD)
#undef CHECK_FIELD
  }
}

TEST(PathState, WhatNoFeatureNeedsTakesNothing) {
  EXPECT_EQ(path_words(0), 0);
  EXPECT_EQ(slot_words(0), 0);
  int surface = 0, uv = 0;
#define ADD_WORDS(sum, type, name) (sum) += kWords<type>;
  SURFACE_HIT_FIELDS(ADD_WORDS, surface)
  SURFACE_UV_FIELDS(ADD_WORDS, uv)
#undef ADD_WORDS
  const int least = path_words(FEATURE_PATH);
  EXPECT_GT(least, 0);
  EXPECT_EQ(path_words(FEATURE_PATH | FEATURE_LAYERS | FEATURE_BVH | FEATURE_SAMPLERS), least);
  EXPECT_EQ(path_words(FEATURE_DIRECT), least + surface) << "it keeps a surface";
  EXPECT_EQ(path_words(FEATURE_DIRECT | FEATURE_UV), least + surface + uv) << "and where on it";
  EXPECT_EQ(path_words(FEATURE_PATH | FEATURE_UV), least) << "needs both features";
  EXPECT_EQ(path_words(FEATURE_PATH | FEATURE_PROJECTED), least + kWords<vec3>) << "a normal";
  EXPECT_GT(path_words(FEATURE_PATH | FEATURE_POLYGONS), least);
  EXPECT_EQ(path_words(FEATURE_PATH | FEATURE_POSITION_LAYER | FEATURE_SHAPE_LAYER), least);
  EXPECT_EQ(path_words(FEATURE_PATH | FEATURE_INDIRECT_LAYER), least + kWords<vec3>) << "direct light";
  int branch = 0;
#define ADD_WORDS(sum, type, name) (sum) += kWords<type>;
  BRANCH_FIELDS(ADD_WORDS, branch)
#undef ADD_WORDS
  EXPECT_EQ(path_words(FEATURE_WHITTED), least + 3 + MAX_BRANCH_DEPTH * branch) << "a stack";
  EXPECT_EQ(path_words(FEATURE_OCCLUSION), path_words(FEATURE_DIRECT)) << "it keeps a surface too";
  EXPECT_EQ(slot_words(FEATURE_DIRECT), slot_words(FEATURE_PATH));
  EXPECT_GT(slot_words(FEATURE_PATH | FEATURE_LAYERS), slot_words(FEATURE_PATH));
  EXPECT_GT(slot_words(FEATURE_PATH | FEATURE_POLYGONS), slot_words(FEATURE_PATH));
  EXPECT_EQ(slot_words(FEATURE_PATH | FEATURE_SHAPE_LAYER), slot_words(FEATURE_PATH) + 1);
}

TEST(PathState, BranchesAreThoseOfTheirPlaceAndLevel) {
  BlockMemory memory(FEATURE_WHITTED, kCapacity, 0);
  const PathState paths = memory.block().paths;
  const auto value = [](int place, int level) {
    Branch b;
    int field = level;
#define SET_FIELD(_, type, name) b.name = value_of<type>(field += MAX_BRANCH_DEPTH, place);
    BRANCH_FIELDS(SET_FIELD, _)
#undef SET_FIELD
    return b;
  };
  for (int place = 0; place < kCapacity; ++place)
    for (int level = 0; level < MAX_BRANCH_DEPTH; ++level)
      stack_branch(&paths, place, level, value(place, level));
  for (int place = 0; place < kCapacity; ++place)
    for (int level = 0; level < MAX_BRANCH_DEPTH; ++level) {
      const Branch b = stacked_branch(&paths, place, level), expected = value(place, level);
#define CHECK_FIELD(_, type, name) EXPECT_TRUE(same(b.name, expected.name)) << #name << place << level;
      BRANCH_FIELDS(CHECK_FIELD, _)
#undef CHECK_FIELD
    }
}

TEST(PathState, HasFlagsThatAreTrueHoweverTheyAreStored) {
  BlockMemory memory(FEATURE_ALL, LANES, 0);
  const PathState paths = memory.block().paths;
  paths.alive[3] = -7;
  EXPECT_TRUE(get_alive(&paths, 3));
  EXPECT_FALSE(get_alive(&paths, 2));
}

TEST(PathState, FieldsAreStoredForAnyOfTheirFeaturesOrForAll) {
  EXPECT_TRUE(is_stored(1, 1));
  EXPECT_TRUE(is_stored(2, 3));
  EXPECT_FALSE(is_stored(4, 3));
  EXPECT_TRUE(is_stored(7, ALL_OF(3)));
  EXPECT_FALSE(is_stored(6, ALL_OF(3)));
  EXPECT_TRUE(is_stored(FEATURE_LIGHT_EDGES, FEATURE_LIGHT_EDGES));
  EXPECT_FALSE(is_stored(FEATURE_PATH, FEATURE_LIGHT_EDGES));
  EXPECT_TRUE(is_stored(FEATURE_LIGHT_EDGES | FEATURE_MEDIA, ALL_OF(FEATURE_LIGHT_EDGES | FEATURE_MEDIA)));
  EXPECT_FALSE(is_stored(FEATURE_MEDIA, ALL_OF(FEATURE_LIGHT_EDGES | FEATURE_MEDIA)));
  EXPECT_TRUE(is_stored(FEATURE_PATH, EVERY_SCENE));
  EXPECT_FALSE(is_stored(FEATURE_ALL, NEVER));
  EXPECT_TRUE(is_moved(3, ALL_OF(3), 1));
  EXPECT_FALSE(is_moved(2, ALL_OF(3), 1));
  EXPECT_FALSE(is_moved(3, 3, NEVER));
}

class KeptSurface : public testing::TestWithParam<bool> {};
INSTANTIATE_TEST_SUITE_P(Uv, KeptSurface, testing::Bool());

TEST_P(KeptSurface, IsTheOneThatWasKept) {
  const bool with_uv = GetParam();
  const std::uint64_t features = FEATURE_DIRECT | (with_uv ? FEATURE_UV : 0);
  BlockMemory memory(features, kCapacity, 0);
  const PathState paths = memory.block().paths;
  std::vector<Surface> surfaces;
  for (int i = 0; i < kCapacity; ++i) {
    fill_path(features, paths, i);
    Surface s;
    int field = 50;
#define SET_FIELD(_, type, name) s.name = value_of<type>(field++, i);
    SURFACE_FIELDS(SET_FIELD, _)
#undef SET_FIELD
    surfaces.push_back(s);
  }
  for (int i = 0; i < kCapacity; ++i) {
    keep_surface(&paths, i, surfaces[std::size_t(i)]);
    if (with_uv) keep_uv(&paths, i, surfaces[std::size_t(i)]);
  }
  for (int i = 0; i < kCapacity; ++i) {
    Surface s = kept_surface(&paths, i);
    EXPECT_TRUE(same(s.u, 0.0f));
    if (with_uv) s = with_kept_uv(&paths, i, s);
#define CHECK_FIELD(_, type, name) EXPECT_TRUE(same(s.name, surfaces[std::size_t(i)].name)) << #name " " << i;
    SURFACE_HIT_FIELDS(CHECK_FIELD, _)
    if (with_uv) {
      SURFACE_UV_FIELDS(CHECK_FIELD, _)
    }
#undef CHECK_FIELD
    EXPECT_TRUE(same(get_ray_origin(&paths, i), value_of<vec3>(0, i))) << "what lies beside it stays";
  }
}

}  // namespace
}  // namespace penumbra::path_state_test
