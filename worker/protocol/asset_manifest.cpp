#include "worker/protocol/asset_manifest.h"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>

#include "kernels/host/content_hash.h"
#include "kernels/host/device_scene.h"
#include "kernels/host/parallel.h"

namespace penumbra {
namespace {

using Bytes = std::span<const std::uint8_t>;

void cut(Bytes bytes, std::vector<Bytes>& parts) {
  for (std::size_t at = 0; at < bytes.size(); at += kLargestPiece)
    parts.push_back(bytes.subspan(at, std::min(kLargestPiece, bytes.size() - at)));
}

/// Hashes with one thread for each two of the largest pieces. SHA-256 takes a second for one or two GB.
std::vector<AssetPiece> hashed(const std::vector<Bytes>& parts, std::size_t bytes) {
  std::vector<AssetPiece> pieces(parts.size());
  in_parallel(parts.size(), std::min(core_count(), bytes / (2 * kLargestPiece)), [&](std::size_t i) {
    pieces[i] = {content_hash(parts[i]), parts[i].size()};
  });
  return pieces;
}

}  // namespace

std::string hash_of_pieces(const std::vector<AssetPiece>& pieces) {
  std::string text;
  for (const AssetPiece& piece : pieces) text += fmt::format("{} {}\n", piece.hash, piece.size);
  return content_hash({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
}

std::size_t AssetManifest::bytes() const {
  return std::accumulate(pieces.begin(), pieces.end(), std::size_t(0),
                         [](std::size_t sum, const AssetPiece& piece) { return sum + piece.size; });
}

AssetManifest make_manifest(std::span<const std::uint8_t> head, std::span<const std::uint8_t> body,
                            std::span<const std::size_t> starts) {
  std::vector<Bytes> parts;
  cut(head, parts);
  std::size_t from = 0;
  for (const std::size_t start : starts) {
    const std::size_t to = std::clamp(start, from, body.size());
    cut(body.subspan(from, to - from), parts);
    from = to;
  }
  cut(body.subspan(from), parts);
  AssetManifest manifest;
  manifest.pieces = hashed(parts, head.size() + body.size());
  manifest.hash = hash_of_pieces(manifest.pieces);
  return manifest;
}

AssetManifest manifest_of(const DeviceScene& scene) {
  std::vector<std::size_t> starts;
  for (const SceneTable& table : kSceneTables)
    starts.push_back(std::size_t((scene.header.tables.*table.span).offset) * sizeof(std::uint32_t));
  std::ranges::sort(starts);
  return make_manifest(scene.head(), scene.body(), starts);
}

}  // namespace penumbra
