#include "worker/worker_pieces.h"

namespace penumbra {

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

std::optional<std::vector<std::uint8_t>> WorkerPieces::read(const AssetPiece& piece) {
  if (const auto held = held_.find(piece.hash); held != held_.end())
    return std::vector<std::uint8_t>(held->second.begin(), held->second.end());
  return cache_.read(piece);
}

void WorkerPieces::reject(const AssetPiece& piece) {
  if (held_.erase(piece.hash) == 0) cache_.reject(piece);
}

}  // namespace penumbra
