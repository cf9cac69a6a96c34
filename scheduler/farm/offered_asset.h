// Data that a scheduler offers to workers for download.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "worker/protocol/asset_manifest.h"

namespace penumbra {

/// An asset in two consecutive parts. The body is not copied, so a large scene is in memory once.
struct OfferedAsset {
  AssetManifest manifest;  ///< describes both parts
  std::vector<std::uint8_t> head;
  std::span<const std::uint8_t> body;
  std::shared_ptr<const void> owner;  ///< keeps the body's memory alive
};

}  // namespace penumbra
