// Data that a scheduler offers to workers.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "scheduler/protocol/asset_manifest.h"

namespace penumbra {

/// Two parts, one after the other; the second stays where it is, so that a large scene is not there twice.
struct OfferedAsset {
  AssetManifest manifest;  ///< of both
  std::vector<std::uint8_t> head;
  std::span<const std::uint8_t> body;
  std::shared_ptr<const void> owner;  ///< of the body
};

}  // namespace penumbra
