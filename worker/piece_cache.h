// A cache of scene pieces on disk, so that a worker that restarts, or runs beside others, need not download
// them.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "kernels/host/cache_folder.h"
#include "worker/protocol/scene_fetch.h"

namespace penumbra {

/// Default size limit. Home folders on clusters have quotas of some ten GB.
constexpr std::uint64_t kPieceCacheBytes = std::uint64_t(4) << 30;

/// The folder: PENUMBRA_CACHE, else penumbra/scenes below XDG_CACHE_HOME or ~/.cache. Empty (no cache) if
/// PENUMBRA_CACHE=off, or if none of these variables is set; also for a scheduler at a Unix socket, which is
/// on this machine: its memory is faster than a disk.
std::filesystem::path default_piece_cache(const std::string& scheduler_address);

/// One file per piece, named after its hash. Several workers may share a folder without locks. An incomplete
/// file is removed and never returned; one that does not match its hash is removed when its reader calls
/// reject(). At most `most_bytes` remain when no worker is downloading; meanwhile there may also be what
/// workers are writing. If the folder is full or cannot be written, rendering goes on without it.
class PieceCache final : public PieceStore {
 public:
  /// With an empty folder nothing is found or stored.
  PieceCache(std::filesystem::path folder, std::uint64_t most_bytes);
  ~PieceCache() override;
  PieceCache(const PieceCache&) = delete;
  PieceCache& operator=(const PieceCache&) = delete;

  bool may_have(const AssetPiece& piece) override;
  void expect(std::uint64_t missing, std::uint64_t total) override;
  std::optional<std::vector<std::uint8_t>> read(const AssetPiece& piece) override;
  void reject(const AssetPiece& piece) override;
  void keep(const AssetPiece& piece, std::span<const std::uint8_t> bytes) override;

  [[nodiscard]] std::filesystem::path file_of(const AssetPiece& piece) const {
    return files_.file_of(piece.hash);
  }
  /// Messages for users since the last call.
  std::vector<std::string> take_notes();

 private:
  const std::uint64_t most_bytes_;
  CacheFolder files_;
  bool keeps_ = true;  // whether the scene that is being downloaded is stored
  bool has_written_ = false;
  std::vector<std::string> notes_;
};

/// Where a worker looks for pieces of a scene before it downloads them: first in the scenes that it has for
/// other jobs, then in its cache on disk.
class WorkerPieces final : public PieceStore {
 public:
  explicit WorkerPieces(PieceCache& cache) : cache_(cache) {}

  /// Both must outlive this object; the scene's words must be unchanged.
  void offer(const DeviceScene& scene, const AssetManifest& manifest);

  bool may_have(const AssetPiece& piece) override;
  void expect(std::uint64_t missing, std::uint64_t total) override { cache_.expect(missing, total); }
  std::span<const std::uint8_t> held(const AssetPiece& piece) override;
  std::optional<std::vector<std::uint8_t>> read(const AssetPiece& piece) override {
    return cache_.read(piece);
  }
  void reject(const AssetPiece& piece) override { cache_.reject(piece); }
  void keep(const AssetPiece& piece, std::span<const std::uint8_t> bytes) override {
    cache_.keep(piece, bytes);
  }

 private:
  PieceCache& cache_;
  std::map<std::string, std::span<const std::uint8_t>> held_;  // by hash
};

}  // namespace penumbra
