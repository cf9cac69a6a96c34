// Results that are cut into messages and put together again.
#include "worker/protocol/unit_result.h"

#include <gmock/gmock.h>

#include <functional>

#include "tests/support/fake_samples.h"

namespace penumbra {
namespace {

using testing::HasSubstr;

constexpr RenderUnit kArea{.x = 16, .y = 32, .width = 9, .height = 7, .first_sample = 8, .sample_count = 3};
const FilmLayers kLayers(FEATURE_LAYERS, 9);

SampleBuffer buffer_with_mattes() {
  SampleBuffer buffer = fake_samples(kArea, kLayers);
  for (std::size_t pixel = 0; pixel < buffer.pixels(); ++pixel)
    buffer.mattes.insert(buffer.mattes.end(), {2u, std::uint32_t(NO_MATTE), 1u, 9u, kArea.sample_count - 1});
  return buffer;
}

std::vector<wire::WorkerMessage> cut(const SampleBuffer& buffer, std::size_t most_bytes) {
  const wire::UnitId id;
  ResultCutter cutter(id, buffer);
  std::vector<wire::WorkerMessage> messages;
  do messages.emplace_back();
  while (!cutter.next(most_bytes, messages.back()));
  return messages;
}

/// The error of the first message that has one.
Expected<SampleBuffer> put_together(const std::vector<wire::WorkerMessage>& messages,
                                    const FilmLayers& layers = kLayers, std::uint64_t* hash = nullptr) {
  ResultAssembly assembly(kArea, layers);
  for (const wire::WorkerMessage& message : messages) {
    if (message.has_result()) {
      Expected<SampleBuffer> buffer = assembly.finish(message.result());
      if (hash != nullptr) *hash = assembly.hash();
      return buffer;
    }
    if (const Expected<void> added = assembly.add(message.part()); !added)
      return std::unexpected(added.error());
  }
  return fail("no end");
}

std::string error_of(const std::vector<wire::WorkerMessage>& messages, const FilmLayers& layers = kLayers) {
  const Expected<SampleBuffer> buffer = put_together(messages, layers);
  return buffer ? "none" : buffer.error().message;
}

TEST(ResultParts, TogetherAreTheResultWhateverTheirSize) {
  const SampleBuffer buffer = buffer_with_mattes();
  for (const std::size_t size : {4u, 60u, 1000u, 3276u, 3280u, 4532u, 4536u, 1u << 20}) {
    SCOPED_TRACE(size);
    const auto messages = cut(buffer, size);
    const std::size_t bytes = (buffer.values.size() + buffer.mattes.size()) * 4;
    EXPECT_EQ(messages.size(), (bytes + size - 1) / size);
    std::uint64_t hash = 0;
    const Expected<SampleBuffer> together = put_together(messages, kLayers, &hash);
    ASSERT_TRUE(together) << together.error().message;
    EXPECT_EQ(together->values, buffer.values);
    EXPECT_EQ(together->mattes, buffer.mattes);
    EXPECT_EQ(together->flagged[BAD_NAN].count, buffer.flagged[BAD_NAN].count);
    EXPECT_EQ(hash, result_hash(buffer));
  }
}

TEST(ResultParts, ThatAreWrongAreRefusedInWords) {
  const auto good = cut(buffer_with_mattes(), 500);
  ASSERT_EQ(error_of(good), "none");
  const auto changed = [&](const std::function<void(std::vector<wire::WorkerMessage>&)>& change) {
    auto messages = good;
    change(messages);
    return error_of(messages);
  };
  EXPECT_THAT(changed([](auto& m) { m.erase(m.begin()); }), HasSubstr("mattes after 2776 bytes of samples"));
  EXPECT_THAT(changed([](auto& m) { m.insert(m.begin(), m.front()); }), HasSubstr("3500 bytes of samples"));
  EXPECT_THAT(changed([](auto& m) { std::swap(m[0], m[1]); }), HasSubstr("checksum"));
  EXPECT_THAT(changed([](auto& m) { m[0].mutable_part()->clear_values(); }), HasSubstr("empty"));
  EXPECT_THAT(changed([](auto& m) { m[0].mutable_part()->mutable_values()->pop_back(); }),
              HasSubstr("499 bytes of samples"));
  EXPECT_THAT(changed([](auto& m) { m[0].mutable_part()->mutable_values()->resize(kMostPartBytes + 4); }),
              HasSubstr("at most 1048576"));
  EXPECT_THAT(changed([](auto& m) { m[0].mutable_part()->mutable_values()->resize(kMostPartBytes); }),
              HasSubstr("1048576 bytes of samples instead of 3276"));
  EXPECT_THAT(changed([](auto& m) { m[0].mutable_part()->add_mattes(1); }), HasSubstr("mattes after 500"));
  EXPECT_THAT(changed([](auto& m) { m[7].mutable_part()->mutable_mattes()->Resize(200'000, 1); }),
              HasSubstr("mattes of more pixels"));
  EXPECT_THAT(changed([](auto& m) { m.erase(m.end() - 2); }), HasSubstr("checksum"));
  EXPECT_THAT(changed([](auto& m) { m.back().mutable_result()->mutable_pixels()->set_width(8); }),
              HasSubstr("8 x 7 pixels"));
  EXPECT_THAT(error_of(good, FilmLayers(FEATURE_LAYERS)), HasSubstr("the scene has none"));
  EXPECT_THAT(error_of(cut(fake_samples(kArea, FilmLayers()), 500)), HasSubstr("6 planes"));
}

TEST(ResultParts, AnInvalidValueIsNamedOnlyIfItWasSentSo) {
  SampleBuffer buffer = buffer_with_mattes();
  buffer.values[70] = -std::numeric_limits<float>::infinity();
  auto messages = cut(buffer, 500);
  EXPECT_THAT(error_of(messages), HasSubstr("-inf as a mean radiance of its pixel (7, 0)"));
  messages.back().mutable_result()->mutable_pixels()->set_checksum(1);
  EXPECT_THAT(error_of(messages), HasSubstr("checksum"));
}

}  // namespace
}  // namespace penumbra
