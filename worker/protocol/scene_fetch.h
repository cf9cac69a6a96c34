// Fetches a device scene from a scheduler: only the pieces that are not present already.
#pragma once

#include <grpcpp/client_context.h>

#include <cstdint>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "kernels/host/device_scene.h"
#include "kernels/host/error.h"
#include "penumbra.grpc.pb.h"
#include "worker/protocol/asset_manifest.h"

namespace penumbra {

/// A local store of pieces, which need not be transferred then.
class PieceStore {
 public:
  virtual ~PieceStore() = default;
  /// Whether the piece is probably in the store. `read` may still return nothing.
  virtual bool may_have(const AssetPiece& piece) = 0;
  /// Called after may_have was asked for all pieces of a scene: the number of bytes missing and in total.
  virtual void expect(std::uint64_t missing, std::uint64_t total) = 0;
  /// The bytes of a piece that is in memory and was verified; empty: it is not there.
  virtual std::span<const std::uint8_t> held(const AssetPiece& /*piece*/) { return {}; }
  /// The stored bytes under the piece's name, or nothing. The caller verifies them.
  virtual std::optional<std::vector<std::uint8_t>> read(const AssetPiece& piece) = 0;
  /// The bytes that were read are not the piece.
  virtual void reject(const AssetPiece& piece) = 0;
  /// Stores a piece that was received and verified.
  virtual void keep(const AssetPiece& piece, std::span<const std::uint8_t> bytes) = 0;
};

struct FetchedScene {
  DeviceScene scene;
  AssetManifest manifest;
  SceneBytes bytes;
};

/// Fetches one scene, once. Beside the scene only one piece is in memory at a time.
class SceneFetch {
 public:
  /// `token` may be empty, `store` null.
  SceneFetch(penumbra::v1::Farm::Stub& stub, std::string token, PieceStore* store = nullptr)
      : stub_(stub), token_(std::move(token)), store_(store) {}

  /// Fetches the scene of that hash. Errors: the scheduler does not have it, the received data are damaged,
  /// `cancel` was called.
  Expected<FetchedScene> fetch(const std::string& hash);
  /// May be called from another thread: `fetch` then fails soon.
  void cancel();

 private:
  class Call;
  class Stream;
  Expected<AssetManifest> fetch_manifest(const std::string& hash);
  Expected<std::vector<std::uint8_t>> take_piece(const AssetManifest& manifest, std::size_t index,
                                                 Stream& stream, bool streamed, FetchedScene& fetched);

  penumbra::v1::Farm::Stub& stub_;
  const std::string token_;
  PieceStore* const store_;
  std::mutex mutex_;
  grpc::ClientContext* under_way_ = nullptr;
  bool cancelled_ = false;
};

}  // namespace penumbra
