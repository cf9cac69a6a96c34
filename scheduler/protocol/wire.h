// Between the messages of penumbra.proto and the renderer's own types. What arrives is checked here, so that
// nothing behind this file meets a nonsensical value.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "kernels/host/error.h"
#include "kernels/host/sample_buffer.h"
#include "kernels/host/view.h"
#include "penumbra.pb.h"
#include "scheduler/plan/work_unit.h"
#include "scheduler/protocol/asset_manifest.h"
#include "worker/device.h"

namespace penumbra {

namespace wire = penumbra::v1;

constexpr std::uint32_t kProtocolVersion = 12;
constexpr std::size_t kAssetChunkBytes = std::size_t(1) << 20;

/// Bytes that a result's message takes for a pixel at most: all planes; how many pairs of mattes, and those,
/// as variable numbers of 7 bits a byte.
constexpr int kMostPixelBytes = plane_count(FEATURE_ALL) * 4 + 1 + MAX_MATTE_PAIRS * (4 + 2);
static_assert(MAX_MATTES < 1 << 28 && kMaxSamplesPerUnit < 1 << 14 && MAX_MATTE_PAIRS < 1 << 7);

/// Largest message that a peer accepts: a tile of 2048 x 2048 pixels with all of that, and some.
constexpr int kMaxMessageBytes = kMaxTile * kMaxTile * kMostPixelBytes + (1 << 20);

/// Says how the peers' protocol versions differ; empty if they agree. `peer` is "worker" or "scheduler".
std::string version_mismatch(std::uint32_t theirs, std::string_view peer);

wire::Isa encode(Isa isa);

void encode(const DeviceOptions& options, wire::DeviceOptions& message);
/// Fails on an unknown backend or instruction set and on a thread count outside [1, 4096].
Expected<DeviceOptions> decode(const wire::DeviceOptions& message);

/// How a device came to be ready.
void encode(const DevicePreparation& preparation, wire::Ready& message);
/// Fails if the time for the kernels is negative or not finite, or if there are more than kMostWarnings
/// warnings.
Expected<DevicePreparation> decode(const wire::Ready& message);

/// `view`: of the job, when the unit was given out.
void encode(const UnitId& id, std::uint32_t view, wire::UnitId& message);
UnitId decode(const wire::UnitId& message);

void encode(const RenderUnit& unit, wire::Unit& message);
/// Fails unless its work is pixels, their rectangle is not empty, at most kMaxTile a side and the sample
/// count in [1, kMaxSamplesPerUnit].
Expected<RenderUnit> decode(const wire::Unit& message);

/// The buffer, its counts and the checksum.
void encode(const SampleBuffer& buffer, wire::UnitResult& message);
/// Fails, in words for people, if the checksum does not match, the buffer is not one of `unit` in that shape,
/// its values are no statistics (see check_statistics), its mattes none (see check_mattes), or it took a time
/// that is not finite.
Expected<SampleBuffer> decode(const wire::UnitResult& message, const RenderUnit& unit,
                              const FilmLayers& layers);

void encode(const AssetManifest& manifest, wire::AssetManifest& message);
/// Fails unless it is the one of that hash, with pieces of 1 to kLargestPiece bytes whose names are hashes.
Expected<AssetManifest> decode(const wire::AssetManifest& message, const std::string& hash);

void encode(const View& view, wire::View& message);
/// Fails unless all its numbers are there and finite.
Expected<View> decode(const wire::View& message);

/// The first 64 bits of the content digest of everything that must be equal in two results of one unit: a
/// worker cannot make another result of the same hash.
std::uint64_t result_hash(const wire::UnitResult& message);

}  // namespace penumbra
