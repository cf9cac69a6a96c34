// Content hashes have the values of the SHA-256 standard, and tell contents apart for which anybody can make
// XXH3 collide. Also tests the texts that users read when a call fails.
#include "kernels/host/content_hash.h"

#include <gtest/gtest.h>
#include <xxhash.h>

#include <cstring>
#include <string>
#include <vector>

#include "tests/support/fake_samples.h"
#include "tests/support/xxh3_twins.h"
#include "worker/protocol/asset_manifest.h"
#include "worker/protocol/client.h"
#include "worker/protocol/unit_result.h"

namespace penumbra {
namespace {

std::span<const std::uint8_t> bytes_of(std::string_view text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

/// NIST's examples of SHA-256: https://csrc.nist.gov/projects/cryptographic-standards-and-guidelines
TEST(ContentHash, HasTheValuesOfTheStandard) {
  EXPECT_EQ(content_hash(bytes_of("abc")),
            "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  EXPECT_EQ(content_hash({}), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
  EXPECT_EQ(content_hash(bytes_of("abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq")),
            "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1");
  EXPECT_EQ(content_digest({bytes_of("a"), {}, bytes_of("bc")}), content_digest({bytes_of("abc")}));
}

TEST(ContentHash, IsKnownByItsLook) {
  EXPECT_TRUE(is_content_hash(content_hash({})));
  for (const std::string& other : {std::string(64, 'g'), std::string(63, 'a'), std::string(65, 'a'),
                                   std::string(32, 'a'), std::string(64, 'A'), std::string()})
    EXPECT_FALSE(is_content_hash(other)) << other;
}

TEST(ContentHash, TellsApartWhatXxh3DoesNot) {
  const auto [one, other] = xxh3_twins();
  const auto of = [](const DeviceScene& scene) {
    const std::vector<std::uint8_t> bytes = scene.serialize();
    constexpr std::size_t kSize = kTwinWords * sizeof(std::uint32_t);
    return std::pair(XXH3_128bits(bytes.data() + bytes.size() - kSize, kSize), manifest_of(scene));
  };
  const auto [one_xxh3, one_manifest] = of(one);
  const auto [other_xxh3, other_manifest] = of(other);
  ASSERT_NE(one.words, other.words);
  ASSERT_TRUE(XXH128_isEqual(one_xxh3, other_xxh3)) << "the attack is one";
  ASSERT_EQ(one_manifest.pieces.back().size, kTwinWords * sizeof(std::uint32_t));
  EXPECT_NE(one_manifest.pieces.back().hash, other_manifest.pieces.back().hash);
  EXPECT_NE(one_manifest.hash, other_manifest.hash);
}

/// What a worker returns is taken for verified where another one's has the same hash.
TEST(ResultHash, TellsApartWhatTheChecksumDoesNot) {
  const RenderUnit unit{.x = 0, .y = 0, .width = 32, .height = 32, .first_sample = 0, .sample_count = 3};
  SampleBuffer one = fake_samples(unit, kNoLayers);
  const auto [values, twin] = xxh3_twins();
  const auto take = [](const DeviceScene& from, SampleBuffer& to) {
    std::memcpy(to.values.data(), from.words.data() + from.words.size() - kTwinWords,
                kTwinWords * sizeof(float));
  };
  take(values, one);
  SampleBuffer other = one;
  take(twin, other);
  wire::UnitResult one_message, other_message;
  encode(one, one_message);
  encode(other, other_message);
  ASSERT_EQ(one_message.pixels().checksum(), other_message.pixels().checksum()) << "the attack is one";
  EXPECT_NE(result_hash(one), result_hash(other));
}

/// gRPC's own texts are for whoever debugs it: "Socket closed", "failed to connect to all addresses; last …".
TEST(StatusText, IsOurs) {
  for (const auto code :
       {grpc::StatusCode::UNAVAILABLE, grpc::StatusCode::CANCELLED, grpc::StatusCode::INTERNAL,
        grpc::StatusCode::UNKNOWN, grpc::StatusCode::DEADLINE_EXCEEDED, grpc::StatusCode::UNIMPLEMENTED}) {
    const std::string text = status_text({code, "Received RST_STREAM with error code 2"});
    EXPECT_EQ(text.find("RST_STREAM"), std::string::npos) << text;
    EXPECT_FALSE(text.empty());
  }
  const std::string large =
      status_text({grpc::StatusCode::RESOURCE_EXHAUSTED, "Received message larger than max (4 vs. 3)"});
  EXPECT_EQ(large.find("larger than max"), std::string::npos) << large;
  for (const auto code : {grpc::StatusCode::UNAUTHENTICATED, grpc::StatusCode::PERMISSION_DENIED}) {
    const std::string text = status_text({code, "Received http2 header with status: 403"});
    EXPECT_EQ(text.find("http2"), std::string::npos) << text;
  }
  EXPECT_EQ(status_text({grpc::StatusCode::DATA_LOSS, "x"}).find('x'), std::string::npos);
  EXPECT_EQ(status_text({grpc::StatusCode::RESOURCE_EXHAUSTED, "the queue is full"}), "the queue is full");
  EXPECT_EQ(status_text({grpc::StatusCode::NOT_FOUND, "there is no job 5"}), "there is no job 5");
}

}  // namespace
}  // namespace penumbra
