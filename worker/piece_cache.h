// Pieces of scenes on disk, so that a worker that starts again, or starts beside others, need not fetch them.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "scheduler/protocol/scene_fetch.h"
#include "worker/cache_folder.h"

namespace penumbra {

/// What a worker keeps by default. Home folders of clusters have quotas of some ten GB.
constexpr std::uint64_t kPieceCacheBytes = std::uint64_t(4) << 30;

/// The user's choice of folder: PENUMBRA_CACHE, else penumbra/scenes below XDG_CACHE_HOME or ~/.cache. Empty,
/// which is no cache: PENUMBRA_CACHE=off, or none of these variables is set; and for a scheduler at a Unix
/// socket, which is on this machine: its memory is nearer than a disk.
std::filesystem::path default_piece_cache(const std::string& scheduler_address);

/// A file for each piece, named after its hash. Several workers may use one folder: nothing is locked, and
/// what is not whole is removed and never returned; what is not what its name
/// says is removed once whoever reads it finds out. At most `most_bytes` stay
/// when nobody fetches; while some do, what they are just writing may be there beside. A folder that is full
/// or cannot be written is none: rendering goes on without it.
class PieceCache final : public PieceStore {
 public:
  /// An empty folder: nothing is found and nothing kept.
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
  /// What is to be said of it, since the last call.
  std::vector<std::string> take_notes();

 private:
  const std::uint64_t most_bytes_;
  CacheFolder files_;
  bool keeps_ = true;  // of the scene that is being fetched
  bool has_written_ = false;
  std::vector<std::string> notes_;
};

}  // namespace penumbra
