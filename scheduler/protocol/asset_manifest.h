// How a device scene travels: in pieces, each by its content, so that a scene of which a part has changed
// brings only that part.
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
  std::string hash;  ///< of its bytes, see content_hash
  std::size_t size = 0;
  bool operator==(const AssetPiece&) const = default;
};

/// The pieces of an asset, one after the other. Its hash is over their hashes and sizes, so that it is the
/// same for equal bytes that are cut alike, and whoever has verified it and every piece has verified all.
struct AssetManifest {
  std::string hash;
  std::vector<AssetPiece> pieces;

  [[nodiscard]] std::size_t bytes() const;
};

/// Hashes every byte once. `starts`: of bytes of the body where a piece begins, ascending; longer pieces than
/// kLargestPiece are cut further, always at the same distance from their start. The head is the first one.
AssetManifest make_manifest(std::span<const std::uint8_t> head, std::span<const std::uint8_t> body,
                            std::span<const std::size_t> starts);
/// Of a scene: its header with camera and integrator, and each of its tables. Another camera is another
/// first piece; another material, that and another table of materials.
AssetManifest manifest_of(const DeviceScene& scene);
/// The name of an asset of these pieces.
std::string hash_of_pieces(const std::vector<AssetPiece>& pieces);

/// How somebody came by a scene, in bytes.
struct SceneBytes {
  std::uint64_t fetched = 0;  ///< that travelled
  std::uint64_t found = 0;    ///< that did not have to
};

}  // namespace penumbra
