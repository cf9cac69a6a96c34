// Where a worker looks for pieces of a scene before it downloads them.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "worker/piece_cache.h"

namespace penumbra {

/// First the scenes that it has for other jobs, then its cache on disk.
class WorkerPieces final : public PieceStore {
 public:
  explicit WorkerPieces(PieceCache& cache) : cache_(cache) {}

  /// Both must outlive this object; the scene's words must be unchanged.
  void offer(const DeviceScene& scene, const AssetManifest& manifest);

  bool may_have(const AssetPiece& piece) override;
  void expect(std::uint64_t missing, std::uint64_t total) override { cache_.expect(missing, total); }
  std::optional<std::vector<std::uint8_t>> read(const AssetPiece& piece) override;
  void reject(const AssetPiece& piece) override;
  void keep(const AssetPiece& piece, std::span<const std::uint8_t> bytes) override {
    cache_.keep(piece, bytes);
  }

 private:
  PieceCache& cache_;
  std::map<std::string, std::span<const std::uint8_t>> held_;  // by hash
};

}  // namespace penumbra
