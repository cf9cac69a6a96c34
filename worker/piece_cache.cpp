#include "worker/piece_cache.h"

#include <fcntl.h>
#include <fmt/format.h>

#include <cstdlib>
#include <utility>

namespace penumbra {

namespace fs = std::filesystem;

fs::path default_piece_cache(const std::string& scheduler_address) {
  const bool is_near = scheduler_address.starts_with("unix:");
  const char* chosen = std::getenv("PENUMBRA_CACHE");
  return is_near && (chosen == nullptr || *chosen == '\0') ? fs::path()
                                                           : cache_folder("PENUMBRA_CACHE", "scenes");
}

PieceCache::PieceCache(fs::path folder, std::uint64_t most_bytes)
    : most_bytes_(most_bytes), files_(std::move(folder), ".piece", {.most_bytes = most_bytes}) {}

PieceCache::~PieceCache() {
  if (has_written_) files_.remove_oldest();
}

std::vector<std::string> PieceCache::take_notes() { return std::exchange(notes_, {}); }

/// An existing file is marked as used, so that it is not removed to make room for the scene's other pieces.
bool PieceCache::may_have(const AssetPiece& piece) {
  if (!files_.enabled()) return false;
  CacheFile file(file_of(piece), O_RDONLY | O_NONBLOCK);
  if (!file.is_open()) return false;
  file.touch();
  return true;
}

void PieceCache::expect(std::uint64_t missing, std::uint64_t total) {
  if (!files_.enabled() || missing == 0) return;
  keeps_ = total <= most_bytes_;  // pieces of a larger scene would evict each other
  if (keeps_)
    files_.remove_oldest(missing);
  else
    notes_.push_back(fmt::format("a scene of {} bytes is not kept in {}, whose limit is {} bytes", total,
                                 files_.path().string(), most_bytes_));
}

std::optional<std::vector<std::uint8_t>> PieceCache::read(const AssetPiece& piece) {
  if (!files_.enabled()) return {};
  CacheFile file(file_of(piece), O_RDONLY | O_NONBLOCK);
  if (!file.is_open()) return {};
  const auto size = file.size();
  if (size && *size == piece.size) {
    std::vector<std::uint8_t> bytes(piece.size);
    if (file.read(bytes.data(), bytes.size()) == bytes.size()) return bytes;
  }
  reject(piece);
  return {};
}

void PieceCache::reject(const AssetPiece& piece) {
  files_.remove(piece.hash);
  notes_.push_back(fmt::format("{} was damaged and is removed", file_of(piece).string()));
}

void PieceCache::keep(const AssetPiece& piece, std::span<const std::uint8_t> bytes) {
  if (!files_.enabled() || !keeps_) return;
  const std::span<const std::uint8_t> parts[] = {bytes};
  if (const auto written = files_.write(piece.hash, parts); !written) {
    keeps_ = false;  // a full disk stays full for a while; the next scene tries again
    notes_.push_back("scenes are not kept: " + written.error().message);
    return;
  }
  has_written_ = true;
}

/// Not the head of the scene, which a new view changes.
void WorkerPieces::offer(const DeviceScene& scene, const AssetManifest& manifest) {
  const std::size_t head = manifest.bytes() - scene.body().size();
  std::size_t at = 0;
  for (const AssetPiece& piece : manifest.pieces) {
    if (at >= head) held_[piece.hash] = scene.body().subspan(at - head, piece.size);
    at += piece.size;
  }
}

bool WorkerPieces::may_have(const AssetPiece& piece) {
  return held_.contains(piece.hash) || cache_.may_have(piece);
}

std::span<const std::uint8_t> WorkerPieces::held(const AssetPiece& piece) {
  const auto held = held_.find(piece.hash);
  return held == held_.end() || held->second.size() != piece.size ? std::span<const std::uint8_t>()
                                                                  : held->second;
}

}  // namespace penumbra
