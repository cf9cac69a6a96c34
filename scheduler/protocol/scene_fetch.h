// A device scene from a scheduler: only the pieces that are not at hand already.
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
#include "scheduler/protocol/asset_manifest.h"

namespace penumbra {

/// Where pieces may be found that need not travel.
class PieceStore {
 public:
  virtual ~PieceStore() = default;
  /// Whether it seems to be there; what `read` then finds may be nothing all the same.
  virtual bool may_have(const AssetPiece& piece) = 0;
  /// After all of a scene's pieces were asked for: the bytes of those that it has not, and of all.
  virtual void expect(std::uint64_t missing, std::uint64_t total) = 0;
  /// What is there under its name, or nothing. Whoever asks verifies it.
  virtual std::optional<std::vector<std::uint8_t>> read(const AssetPiece& piece) = 0;
  /// What was read is not the piece.
  virtual void reject(const AssetPiece& piece) = 0;
  /// One that has come, and is verified.
  virtual void keep(const AssetPiece& piece, std::span<const std::uint8_t> bytes) = 0;
};

struct FetchedScene {
  DeviceScene scene;
  AssetManifest manifest;
  SceneBytes bytes;
};

/// One scene, fetched once. Only one piece is in memory beside the scene.
class SceneFetch {
 public:
  /// `token` may be empty, `store` null.
  SceneFetch(penumbra::v1::Farm::Stub& stub, std::string token, PieceStore* store = nullptr)
      : stub_(stub), token_(std::move(token)), store_(store) {}

  /// The scene of that hash. Errors: the scheduler does not have it, the received data is damaged, `cancel`.
  Expected<FetchedScene> fetch(const std::string& hash);
  /// From another thread: `fetch` fails soon.
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
