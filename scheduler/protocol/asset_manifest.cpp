#include "scheduler/protocol/asset_manifest.h"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>

#include "kernels/host/device_scene_tables.h"
#include "scheduler/protocol/content_hash.h"

namespace penumbra {
namespace {

void add_pieces(std::span<const std::uint8_t> bytes, std::vector<AssetPiece>& pieces) {
  for (std::size_t at = 0; at < bytes.size(); at += kLargestPiece) {
    const auto piece = bytes.subspan(at, std::min(kLargestPiece, bytes.size() - at));
    pieces.push_back({content_hash(piece), piece.size()});
  }
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
  AssetManifest manifest;
  add_pieces(head, manifest.pieces);
  std::size_t from = 0;
  for (const std::size_t start : starts) {
    const std::size_t to = std::clamp(start, from, body.size());
    add_pieces(body.subspan(from, to - from), manifest.pieces);
    from = to;
  }
  add_pieces(body.subspan(from), manifest.pieces);
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
