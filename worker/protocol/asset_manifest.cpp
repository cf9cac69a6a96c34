#include "worker/protocol/asset_manifest.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <numeric>
#include <utility>

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

/// The pieces of the head, then those that begin at each start.
struct Segments {
  std::vector<Bytes> parts;
  std::vector<std::size_t> first;  ///< for each segment its first part, and the end

  Segments(Bytes head, Bytes body, std::span<const std::size_t> starts) {
    add(head);
    std::size_t from = 0;
    for (const std::size_t start : starts) {
      const std::size_t to = std::clamp(start, from, body.size());
      add(body.subspan(from, to - from));
      from = to;
    }
    add(body.subspan(from));
    first.push_back(parts.size());
  }

 private:
  void add(Bytes bytes) {
    first.push_back(parts.size());
    cut(bytes, parts);
  }
};

/// Pieces whose hashes are known already, for each part its own or null.
using KnownPieces = std::vector<const AssetPiece*>;

/// The piece of another manifest for each part that is equal to the part at the same place in its segment.
/// Not for the head, which may have changed since.
KnownPieces known_pieces(const Segments& segments, const Segments& other, const AssetManifest& of_other) {
  KnownPieces known(segments.parts.size(), nullptr);
  if (other.first.size() != segments.first.size() || other.parts.size() != of_other.pieces.size())
    return known;
  std::vector<std::pair<std::size_t, std::size_t>> pairs;
  for (std::size_t s = 1; s + 1 < segments.first.size(); ++s)
    for (std::size_t k = segments.first[s], j = other.first[s];
         k < segments.first[s + 1] && j < other.first[s + 1]; ++k, ++j)
      pairs.emplace_back(k, j);
  in_parallel(pairs.size(), core_count(), [&](std::size_t i) {
    const auto [k, j] = pairs[i];
    const Bytes here = segments.parts[k], there = other.parts[j];
    if (here.size() == there.size() && std::memcmp(here.data(), there.data(), here.size()) == 0)
      known[k] = &of_other.pieces[j];
  });
  return known;
}

/// Hashes with one thread for each two of the largest pieces. SHA-256 takes a second for one or two GB.
AssetManifest manifest_of(const Segments& segments, const KnownPieces& known) {
  const std::vector<Bytes>& parts = segments.parts;
  std::size_t unknown = 0;
  for (std::size_t i = 0; i < parts.size(); ++i) unknown += known[i] == nullptr ? parts[i].size() : 0;
  AssetManifest manifest;
  manifest.pieces.resize(parts.size());
  in_parallel(parts.size(), std::min(core_count(), unknown / (2 * kLargestPiece)), [&](std::size_t i) {
    manifest.pieces[i] =
        known[i] != nullptr ? *known[i] : AssetPiece{content_hash(parts[i]), parts[i].size()};
  });
  manifest.hash = hash_of_pieces(manifest.pieces);
  return manifest;
}

std::vector<std::size_t> starts_of_tables(const DeviceScene& scene) {
  std::vector<std::size_t> starts;
  for (const SceneTable& table : kSceneTables)
    starts.push_back(std::size_t((scene.header.tables.*table.span).offset) * sizeof(std::uint32_t));
  std::ranges::sort(starts);
  return starts;
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
  const Segments segments(head, body, starts);
  return manifest_of(segments, KnownPieces(segments.parts.size(), nullptr));
}

AssetManifest manifest_of(const DeviceScene& scene) {
  return make_manifest(scene.head(), scene.body(), starts_of_tables(scene));
}

AssetManifest manifest_of(const DeviceScene& scene, const DeviceScene& other, const AssetManifest& of_other) {
  const std::vector<std::uint8_t> head = scene.head(), other_head = other.head();
  const Segments segments(head, scene.body(), starts_of_tables(scene));
  return manifest_of(segments,
                     known_pieces(segments, {other_head, other.body(), starts_of_tables(other)}, of_other));
}

}  // namespace penumbra
