// Tests the bytes of checkpoints: what is written can be read again, and damaged bytes are refused.
#include "scheduler/checkpoint/checkpoint.h"

#include <gmock/gmock.h>

#include <cmath>
#include <functional>
#include <random>

#include "tests/scheduler/checkpoint/merged_work.h"
#include "tests/support/film_layers.h"

namespace penumbra {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

std::vector<std::uint8_t> encoded(const Merge& merge, const RenderIdentity& identity = small_identity()) {
  std::vector<std::uint8_t> bytes{1, 2, 3};  // replaced
  encode_checkpoint(identity, merge, 12.5, bytes);
  seal_checkpoint(bytes);
  return bytes;
}

std::string error_of(std::span<const std::uint8_t> bytes, const RenderIdentity& identity = small_identity()) {
  const auto decoded = decode_checkpoint(bytes, identity, empty_merge());
  return decoded ? "none" : decoded.error().message;
}

struct Layout {
  const char* name;
  FilmLayers layers;
};

class CheckpointLayouts : public testing::TestWithParam<Layout> {};

TEST_P(CheckpointLayouts, WhatFollowsMakesTheSameFilm) {
  const auto& [name, layers] = GetParam();
  Merge undisturbed = half_merged(layers);
  auto before = decode_checkpoint(encoded(undisturbed), small_identity(), empty_merge(layers));
  ASSERT_TRUE(before) << before.error().message;
  EXPECT_EQ(before->rendered, 12.5);
  EXPECT_EQ(before->merge.film().hash(), undisturbed.film().hash());
  EXPECT_EQ(before->merge.samples(), undisturbed.samples());
  EXPECT_EQ(before->merge.merged_passes(), undisturbed.merged_passes());
  EXPECT_EQ(before->merge.film().flagged()[BAD_NAN], undisturbed.film().flagged()[BAD_NAN]);
  EXPECT_GT(undisturbed.film().flagged()[BAD_NAN].count, 0u);
  for (Merge* merge : {&undisturbed, &before->merge}) {
    for (std::uint32_t tile = 0; tile < small_grid().tiles(); ++tile)
      for (std::uint32_t pass = 0; pass < small_grid().passes(); ++pass)
        if (!is_merged_first(tile, pass)) merge->add(tile, pass, result(tile, pass, layers));
    EXPECT_EQ(merge->finished_passes(), small_grid().passes());
  }
  EXPECT_EQ(before->merge.film().hash(), undisturbed.film().hash());
  EXPECT_EQ(before->merge.film().flagged()[BAD_NAN], undisturbed.film().flagged()[BAD_NAN]);
  EXPECT_EQ(encoded(before->merge), encoded(undisturbed)) << "also what the hash leaves out";
}

INSTANTIATE_TEST_SUITE_P(Films, CheckpointLayouts,
                         testing::Values(Layout{"radiance", kNoLayers}, Layout{"layers", kFeatureLayers},
                                         Layout{"polygons", kPolygonLayers}),
                         [](const auto& parameter) { return parameter.param.name; });

TEST(Checkpoint, WhatWaitsIsNotKeptAndATileWithAGapBeginsAnew) {
  Merge merge = empty_merge();
  merge.add(0, 0, result(0, 0));
  merge.add(0, 2, result(0, 2));  // waits
  merge.skip(1, 0);
  merge.add(1, 1, result(1, 1));
  merge.add(2, 0, result(2, 0));
  merge.skip(2, 4);  // has not come to that
  auto before = decode_checkpoint(encoded(merge), small_identity(), empty_merge());
  ASSERT_TRUE(before) << before.error().message;
  EXPECT_EQ(before->merge.waiting(), 0u);
  EXPECT_THAT(before->merge.merged_passes(), testing::ElementsAre(1, 0, 1, 0, 0, 0));
  const RenderUnit area = small_grid().unit(1, 0);
  EXPECT_EQ(before->merge.film().at(area.x, area.y).count, 0u);
  for (std::uint32_t tile = 0; tile < small_grid().tiles(); ++tile)
    for (std::uint32_t pass = before->merge.merged_passes()[tile]; pass < small_grid().passes(); ++pass)
      before->merge.add(tile, pass, result(tile, pass));
  EXPECT_EQ(before->merge.finished_passes(), small_grid().passes());
}

TEST(Checkpoint, OfAnotherRenderIsRefusedAndSaysWhatDiffers) {
  const auto bytes = encoded(half_merged());
  const auto refused = [&](const std::function<void(RenderIdentity&)>& change) {
    RenderIdentity asked = small_identity();
    change(asked);
    return error_of(bytes, asked);
  };
  EXPECT_EQ(error_of(bytes), "none");
  EXPECT_THAT(refused([](auto& i) { i.settings[0].second = "4"; }),
              AllOf(HasSubstr("another render"), HasSubstr("seed: 3 there, 4 here"), Not(HasSubstr("spp"))));
  EXPECT_THAT(refused([](auto& i) { i.settings.pop_back(); }), HasSubstr("spp: 22 there, none here"));
  EXPECT_THAT(refused([](auto& i) { i.settings.emplace_back("crop", "0,0,1,1"); }),
              HasSubstr("crop: none there, 0,0,1,1 here"));
  EXPECT_THAT(refused([](auto& i) { i.version = "1.3"; }),
              HasSubstr("version of penumbra: 1.2 there, 1.3 here"));
  EXPECT_THAT(refused([](auto& i) { i.worker = "x"; }), HasSubstr("another build of penumbra-worker"));
  EXPECT_THAT(refused([](auto& i) { i.scene = "x"; }), HasSubstr("what is in the scene"));
  EXPECT_THAT(refused([](auto& i) { std::swap(i.settings[0], i.settings[1]); }), HasSubstr("order"));
}

TEST(Checkpoint, OfAnotherFilmOrGridIsRefused) {
  const auto refuses = [](const Merge& there, Merge asked) {
    return !decode_checkpoint(encoded(there), small_identity(), std::move(asked));
  };
  EXPECT_TRUE(refuses(half_merged(), empty_merge(kNoLayers)));
  EXPECT_TRUE(refuses(half_merged(), empty_merge(kPolygonLayers)));
  EXPECT_TRUE(refuses(half_merged(), {FilmAccumulator(kX, kY, kWidth, kHeight, kFeatureLayers),
                                      TileGrid(kX, kY, kWidth, kHeight, 7, kSpp, kSamplesPerPass)}));
  EXPECT_TRUE(refuses(half_merged(), {FilmAccumulator(kX, kY, kWidth, kHeight, kFeatureLayers),
                                      TileGrid(kX, kY, kWidth, kHeight, 8, kSpp, 5)}))
      << "its pixels would have other samples";
}

TEST(Checkpoint, TruncatedAnywhereIsRefused) {
  const auto bytes = encoded(half_merged());
  std::mt19937 random(1);
  for (std::size_t size = 0; size < 400; ++size) EXPECT_NE(error_of(std::span(bytes).first(size)), "none");
  for (int i = 0; i < 300; ++i) EXPECT_NE(error_of(std::span(bytes).first(random() % bytes.size())), "none");
  std::vector<std::uint8_t> longer = bytes;
  longer.push_back(0);
  EXPECT_THAT(error_of(longer), HasSubstr("damaged"));
}

TEST(Checkpoint, EveryFlippedBitIsNoticed) {
  const auto bytes = encoded(half_merged());
  std::mt19937 random(2);
  for (int i = 0; i < 2000; ++i) {
    std::vector<std::uint8_t> flipped = bytes;
    const std::size_t at = i < 400 ? std::size_t(i) : random() % bytes.size();
    flipped[at] ^= std::uint8_t(1u << random() % 8);
    EXPECT_NE(error_of(flipped), "none") << "byte " << at;
  }
}

/// Behind the checksum: whoever makes one up makes its checksum too. Nothing may crash, hang or take memory
/// that the file does not have, whatever it says; and what is taken must be a film of this grid.
TEST(Checkpoint, MadeUpContentsWithARightChecksumDoNoHarm) {
  std::vector<std::uint8_t> bytes;
  encode_checkpoint(small_identity(), half_merged(), 1, bytes);
  std::mt19937_64 random(3);
  int refused = 0, taken = 0;
  const std::uint64_t nasty[] = {0, 1, ~0ull, 1ull << 63, 1ull << 32, 0x7ff0000000000000, 0x7ff8000000000000};
  for (int i = 0; i < 6000; ++i) {
    std::vector<std::uint8_t> made_up = bytes;
    for (int changes = 1 + int(random() % 3); changes > 0; --changes) {
      // Half of them where the counts and sizes are.
      const std::size_t range = random() % 2 == 0 ? 512 : made_up.size() - 8;
      const std::size_t at = 16 + random() % (range - 16);
      const std::uint64_t value = random() % 2 == 0 ? nasty[random() % std::size(nasty)] : random();
      const std::size_t width = random() % 2 == 0 ? 8 : 1;
      for (std::size_t k = 0; k < width; ++k) made_up[at + k] = std::uint8_t(value >> (8 * k));
    }
    if (random() % 8 == 0) made_up.resize(random() % made_up.size());
    seal_checkpoint(made_up);
    auto decoded = decode_checkpoint(made_up, small_identity(), empty_merge());
    ++(decoded ? taken : refused);
    if (!decoded) continue;
    EXPECT_TRUE(std::isfinite(decoded->merge.film().relative_error()) || decoded->merge.samples() == 0);
    decoded->merge.redo(0);
    for (std::uint32_t tile = 0; tile < small_grid().tiles(); ++tile)
      EXPECT_LE(decoded->merge.merged_passes()[tile], small_grid().passes());
  }
  EXPECT_GT(refused, 2000);
  EXPECT_GT(taken, 500) << "other radiance is possible";
}

}  // namespace
}  // namespace penumbra
