// The manifest of a device scene. A scene is transferred in pieces that are addressed by their content
// hashes. If a part of a scene has changed, only its pieces are transferred.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "kernels/host/device_scene.h"

namespace penumbra {

constexpr std::size_t kLargestPiece = std::size_t(16) << 20;  ///< bytes

struct AssetPiece {
  std::string hash;  ///< of its bytes; see content_hash
  std::size_t size = 0;
  bool operator==(const AssetPiece&) const = default;
};

/// The pieces of an asset, one after the other. The asset's hash covers the hashes and sizes of its pieces.
/// So equal bytes that are cut alike have the same hash, and verifying the manifest and every piece verifies
/// the whole asset.
struct AssetManifest {
  std::string hash;
  std::vector<AssetPiece> pieces;

  [[nodiscard]] std::size_t bytes() const;
};

/// Makes a manifest; every byte is hashed once. The head is the first piece. `starts`: ascending offsets in
/// the body at which pieces begin. Pieces longer than kLargestPiece are cut further, at fixed distances from
/// their start.
AssetManifest make_manifest(std::span<const std::uint8_t> head, std::span<const std::uint8_t> body,
                            std::span<const std::size_t> starts);
/// The manifest of a scene: a piece for the header with camera and integrator, and at least one for each
/// table. Another camera changes only the first piece; another material changes that and the table of
/// materials.
AssetManifest manifest_of(const DeviceScene& scene);
/// The same, faster where pieces of tables are equal to those of another scene with that manifest: comparing
/// bytes takes a tenth of the time of hashing them. The other scene's words must be those of its manifest.
AssetManifest manifest_of(const DeviceScene& scene, const DeviceScene& other, const AssetManifest& of_other);
/// The hash of an asset that consists of these pieces.
std::string hash_of_pieces(const std::vector<AssetPiece>& pieces);

/// Where the bytes of a scene came from.
struct SceneBytes {
  std::uint64_t fetched = 0;  ///< bytes that were transferred
  std::uint64_t found = 0;    ///< bytes that were already present
};

}  // namespace penumbra
