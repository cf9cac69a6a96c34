// Fetching a scene from a real server: only pieces that the worker does not have are sent, and damaged pieces
// are refused.
#include "worker/protocol/scene_fetch.h"

#include <gmock/gmock.h>

#include <future>
#include <set>
#include <thread>

#include "kernels/host/content_hash.h"
#include "kernels/host/device_scene.h"
#include "scheduler/farm/private_socket.h"
#include "scheduler/farm/server.h"
#include "tests/support/fake_device.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/xxh3_twins.h"
#include "worker/piece_cache.h"
#include "worker/protocol/client.h"
#include "worker/protocol/wire.h"

namespace penumbra {
namespace {

using namespace std::chrono_literals;
using testing::ElementsAre;
using testing::HasSubstr;

/// Of `triangles` triangles that differ, and two materials.
DeviceScene large_scene(std::size_t triangles) {
  DeviceScene scene = fake_scene(100, 80, false);
  const std::size_t first = scene.words.size(), words = sizeof(Triangle) / 4;
  scene.words.resize(first + triangles * words);
  Triangle triangle{};
  triangle.light = triangle.normals = -1;
  for (std::size_t i = 0; i < triangles; ++i) {
    triangle.p0.x = float(i);
    std::memcpy(scene.words.data() + first + i * words, &triangle, sizeof triangle);
  }
  scene.header.tables.triangles = {int(triangles), std::uint32_t(first)};
  return scene;
}

/// In memory. What it claims to have may be gone or wrong.
class MemoryStore final : public PieceStore {
 public:
  bool may_have(const AssetPiece& piece) override { return pieces_.contains(piece.hash); }
  void reject(const AssetPiece&) override { ++rejected_; }
  void expect(std::uint64_t missing, std::uint64_t total) override { missing_ = missing, total_ = total; }
  std::optional<std::vector<std::uint8_t>> read(const AssetPiece& piece) override {
    if (loses_) return {};
    std::vector<std::uint8_t> bytes = pieces_.at(piece.hash);
    if (damages_) bytes.back() ^= 1;
    return bytes;
  }
  void keep(const AssetPiece& piece, std::span<const std::uint8_t> bytes) override {
    pieces_[piece.hash].assign(bytes.begin(), bytes.end());
  }

  std::map<std::string, std::vector<std::uint8_t>> pieces_;
  std::uint64_t missing_ = 0, total_ = 0;
  int rejected_ = 0;
  bool loses_ = false, damages_ = false;
};

class SceneFetchTest : public testing::Test {
 protected:
  /// Fetches it from a server that has it; how many bytes travelled.
  std::uint64_t fetch(const DeviceScene& scene, PieceStore* store) {
    const AssetManifest manifest = manifest_of(scene);
    server_->add_asset({manifest, scene.head(), scene.body(), nullptr});
    auto fetched = SceneFetch(*stub_, "", store).fetch(manifest.hash);
    server_->remove_asset(manifest.hash);
    EXPECT_TRUE(fetched) << (fetched ? "" : fetched.error().message);
    if (fetched) {
      EXPECT_EQ(fetched->scene.serialize(), scene.serialize());
      EXPECT_EQ(fetched->bytes.fetched + fetched->bytes.found, scene.serialize().size());
    }
    return fetched ? fetched->bytes.fetched : ~std::uint64_t{0};
  }

  PrivateSocket socket_ = PrivateSocket::create().value();
  std::unique_ptr<Server> server_ = Server::listen({.address = socket_.address()}).value();
  std::unique_ptr<wire::Farm::Stub> stub_ = wire::Farm::NewStub(open_channel(socket_.address()));
};

TEST_F(SceneFetchTest, AnotherCameraOrMaterialDoesNotShipTheGeometryAgain) {
  const DeviceScene scene = large_scene(700'000);
  const std::size_t all = scene.serialize().size(), head = scene.head().size();
  ASSERT_GT(all, 2 * kLargestPiece);
  MemoryStore store;
  ASSERT_EQ(fetch(scene, &store), all);
  EXPECT_EQ(store.missing_, all);

  DeviceScene other_camera = scene;
  other_camera.header.camera.origin.x += 1;
  EXPECT_EQ(fetch(other_camera, &store), head);
  EXPECT_EQ(store.missing_, head);
  EXPECT_EQ(store.total_, all);

  DeviceScene other_material = scene;
  Material material;
  std::memcpy(&material, scene.words.data() + 512, sizeof material);
  material.internal += 0.25f;
  std::memcpy(other_material.words.data() + 512, &material, sizeof material);
  const std::uint64_t shipped = fetch(other_material, &store);
  EXPECT_GT(shipped, 0u);
  EXPECT_LT(shipped, all / 1000);

  DeviceScene other_triangle = scene;
  other_triangle.words[other_triangle.words.size() - sizeof(Triangle) / 4] ^= 1;
  EXPECT_LE(fetch(other_triangle, &store), kLargestPiece) << "the last piece of the table";
  RecordProperty("bytes_of_scene", std::to_string(all));
  RecordProperty("bytes_for_another_camera", std::to_string(head));
  RecordProperty("bytes_for_another_material", std::to_string(shipped));
}

TEST_F(SceneFetchTest, TheScenesThatAWorkerHoldsAreASource) {
  const DeviceScene scene = large_scene(1000);
  DeviceScene held = scene;
  const AssetManifest manifest = manifest_of(held);
  held.header.camera.origin.x += 5;  // as another view does
  DeviceScene other_camera = scene;
  other_camera.header.camera.origin.y += 1;
  PieceCache none({}, 0);
  WorkerPieces pieces(none);
  pieces.offer(held, manifest);
  EXPECT_EQ(fetch(other_camera, &pieces), scene.head().size());
  EXPECT_EQ(fetch(scene, &pieces), scene.head().size());
}

TEST_F(SceneFetchTest, AManifestMadeFromThatOfAnotherSceneIsTheSame) {
  const DeviceScene scene = large_scene(1000);
  const AssetManifest manifest = manifest_of(scene);
  EXPECT_EQ(manifest_of(scene, scene, manifest).pieces, manifest.pieces);
  DeviceScene other = scene;
  other.header.camera.origin.x += 5;
  other.words.back() ^= 1;
  EXPECT_EQ(manifest_of(other, scene, manifest).pieces, manifest_of(other).pieces);
  EXPECT_EQ(manifest_of(other, scene, manifest).hash, manifest_of(other).hash);
  const DeviceScene larger = large_scene(2000);
  EXPECT_EQ(manifest_of(larger, scene, manifest).pieces, manifest_of(larger).pieces);
  // A header that was changed after its manifest was made, as by a view.
  DeviceScene viewed = scene;
  viewed.header.camera.origin.x += 7;
  EXPECT_EQ(manifest_of(viewed, viewed, manifest).pieces, manifest_of(viewed).pieces);
}

TEST_F(SceneFetchTest, WhatAStoreHasLostOrDamagedIsFetchedAllTheSame) {
  const DeviceScene scene = large_scene(1000);
  MemoryStore store;
  ASSERT_EQ(fetch(scene, &store), scene.serialize().size());
  store.loses_ = true;
  EXPECT_EQ(fetch(scene, &store), scene.serialize().size());
  EXPECT_EQ(store.rejected_, 0);
  store.loses_ = false;
  store.damages_ = true;
  EXPECT_EQ(fetch(scene, &store), scene.serialize().size());
  EXPECT_EQ(store.rejected_, int(manifest_of(scene).pieces.size()));
  store.damages_ = false;
  EXPECT_EQ(fetch(scene, &store), 0u);
  // One of the middle alone.
  store.pieces_.erase(manifest_of(scene).pieces[1].hash);
  EXPECT_EQ(fetch(scene, &store), manifest_of(scene).pieces[1].size);
}

TEST_F(SceneFetchTest, WhatIsNotThereIsAnError) {
  const auto fetched = SceneFetch(*stub_, "").fetch("0123");
  ASSERT_FALSE(fetched);
  EXPECT_THAT(fetched.error().message, HasSubstr("cannot fetch the scene 0123: there is no asset '0123'"));
}

TEST_F(SceneFetchTest, DamagedDataIsRefused) {
  const DeviceScene scene = large_scene(1000);
  const AssetManifest manifest = manifest_of(scene);
  DeviceScene damaged = scene;
  damaged.words.back() ^= 4;
  server_->add_asset({manifest, scene.head(), damaged.body(), nullptr});
  MemoryStore store;
  const auto fetched = SceneFetch(*stub_, "", &store).fetch(manifest.hash);
  ASSERT_FALSE(fetched);
  EXPECT_THAT(fetched.error().message, HasSubstr("the scene that came is damaged"));
  EXPECT_FALSE(store.pieces_.contains(manifest.pieces.back().hash));
}

TEST_F(SceneFetchTest, AnotherSceneUnderTheSameHashIsRefusedWhereverItIsFrom) {
  const auto [scene, twin] = xxh3_twins();
  const AssetManifest manifest = manifest_of(scene);
  server_->add_asset({manifest, scene.head(), twin.body(), nullptr});
  MemoryStore store;
  const auto fetched = SceneFetch(*stub_, "", &store).fetch(manifest.hash);
  ASSERT_FALSE(fetched);
  EXPECT_THAT(fetched.error().message, HasSubstr("the scene that came is damaged"));
  server_->remove_asset(manifest.hash);
  // Somebody else has written it into a cache that workers share.
  const TemporaryFolder folder;
  PieceCache cache(folder.path(), std::uint64_t(1) << 30);
  const AssetPiece& piece = manifest.pieces.back();
  cache.keep(piece, twin.body().last(piece.size));
  WorkerPieces pieces(cache);
  ASSERT_TRUE(pieces.may_have(piece));
  EXPECT_EQ(fetch(scene, &pieces), scene.serialize().size());
  EXPECT_THAT(cache.take_notes(), ElementsAre(HasSubstr("was damaged and is removed")));
  EXPECT_EQ(fetch(scene, &pieces), 0u) << "the cache holds the right one now";
}

TEST_F(SceneFetchTest, ItCanBeCancelled) {
  // A store that takes its time stands in for a slow network.
  class Slow final : public PieceStore {
   public:
    bool may_have(const AssetPiece&) override { return false; }
    void expect(std::uint64_t, std::uint64_t) override {}
    std::optional<std::vector<std::uint8_t>> read(const AssetPiece&) override { return {}; }
    void reject(const AssetPiece&) override {}
    void keep(const AssetPiece&, std::span<const std::uint8_t>) override {
      if (!began_) began_ = true, begun.set_value();
      std::this_thread::sleep_for(100ms);
    }
    std::promise<void> begun;

   private:
    bool began_ = false;
  };
  const DeviceScene scene = large_scene(1'400'000);
  const AssetManifest manifest = manifest_of(scene);
  server_->add_asset({manifest, scene.head(), scene.body(), nullptr});
  Slow store;
  SceneFetch fetch(*stub_, "", &store);
  std::thread cancels([&] {
    store.begun.get_future().wait();
    fetch.cancel();
  });
  EXPECT_FALSE(fetch.fetch(manifest.hash));
  cancels.join();
  EXPECT_FALSE(fetch.fetch(manifest.hash)) << "for good";
}

TEST(AssetManifest, IsAFunctionOfTheBytesAndCuts) {
  const DeviceScene scene = large_scene(700'000);
  const AssetManifest manifest = manifest_of(scene);
  EXPECT_EQ(manifest.bytes(), scene.serialize().size());
  EXPECT_EQ(manifest_of(scene).hash, manifest.hash);
  EXPECT_EQ(manifest.pieces[0].hash, content_hash(scene.head()));
  for (const AssetPiece& piece : manifest.pieces) {
    EXPECT_LE(piece.size, kLargestPiece);
    EXPECT_GE(piece.size, 1u);
  }
  std::set<std::string> hashes = {manifest.hash};
  for (const std::size_t word : {std::size_t(0), std::size_t(600), scene.words.size() - 1}) {
    DeviceScene other = scene;
    other.words[word] ^= 1;
    EXPECT_TRUE(hashes.insert(manifest_of(other).hash).second);
  }
}

}  // namespace
}  // namespace penumbra
