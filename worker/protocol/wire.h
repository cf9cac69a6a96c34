// Converts between the messages of penumbra.proto and the renderer's own types. Received messages are
// validated here, so that the rest of the program sees only valid values.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "kernels/host/error.h"
#include "kernels/host/view.h"
#include "penumbra.pb.h"
#include "worker/device.h"
#include "worker/protocol/asset_manifest.h"
#include "worker/work_unit.h"

namespace penumbra {

namespace wire = penumbra::v1;

constexpr std::uint32_t kProtocolVersion = 15;
constexpr std::size_t kAssetChunkBytes = std::size_t(1) << 20;

/// The largest message that a scheduler accepts. Results and scenes come in parts of at most 1 MiB.
constexpr int kMaxRequestBytes = 4 << 20;

/// The largest message that a worker or a viewer accepts: a tile of 2048 x 2048 pixels with all layers, and a
/// margin.
constexpr int kMaxMessageBytes = kMaxTile * kMaxTile * plane_count(FEATURE_ALL) * 4 + (1 << 20);

/// A text about different protocol versions; empty if they agree. `peer` is "worker" or "scheduler".
std::string version_mismatch(std::uint32_t theirs, std::string_view peer);

wire::Isa encode(Isa isa);

void encode(const DeviceOptions& options, wire::DeviceOptions& message);
/// Errors: an unknown backend or instruction set; a thread count outside [1, 4096].
Expected<DeviceOptions> decode(const wire::DeviceOptions& message);

/// How a device was prepared.
void encode(const DevicePreparation& preparation, wire::Ready& message);
/// Errors: the kernels' time is negative or not finite; more than kMostWarnings warnings.
Expected<DevicePreparation> decode(const wire::Ready& message);

/// `view`: the job's view when the unit was issued.
void encode(const UnitId& id, std::uint32_t view, wire::UnitId& message);
UnitId decode(const wire::UnitId& message);

void encode(const RenderUnit& unit, wire::Unit& message);
/// Errors: the work is not pixels; an empty rectangle, or one of more than kMaxTile on a side; a sample count
/// outside [1, kMaxSamplesPerUnit].
Expected<RenderUnit> decode(const wire::Unit& message);

void encode(const AssetManifest& manifest, wire::AssetManifest& message);
/// Errors: the manifest does not have that hash, a piece is not of 1 to kLargestPiece bytes, a piece's name
/// is not a hash.
Expected<AssetManifest> decode(const wire::AssetManifest& message, const std::string& hash);

void encode(const View& view, wire::View& message);
/// Errors: numbers that are missing or not finite.
Expected<View> decode(const wire::View& message);

}  // namespace penumbra
