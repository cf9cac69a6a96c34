#include "worker/protocol/wire.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>

#include "kernels/host/content_hash.h"
#include "worker/protocol/text.h"

namespace penumbra {
namespace {

bool is_time(double seconds) { return std::isfinite(seconds) && seconds >= 0; }

template <typename Part>
Expected<void> take_floats(const google::protobuf::RepeatedField<float>& field, const char* name,
                           Part& part) {
  decltype(as_floats(part)) floats{};
  if (std::size_t(field.size()) != floats.size())
    return fail(
        fmt::format("a view whose {} has {} numbers instead of {}", name, field.size(), floats.size()));
  std::ranges::copy(field, floats.begin());
  part = std::bit_cast<Part>(floats);
  return {};
}

}  // namespace

std::string version_mismatch(std::uint32_t theirs, std::string_view peer) {
  if (theirs == kProtocolVersion) return {};
  return fmt::format(
      "the {} speaks protocol version {}, this side version {}; use the same release of penumbra and "
      "penumbra-worker",
      peer, theirs, kProtocolVersion);
}

// The numbers of the messages are those of the types here.
static_assert(int(wire::ISA_SSE2) == int(Isa::kSse2) && int(wire::ISA_AVX2) == int(Isa::kAvx2) &&
              int(wire::ISA_AVX512) == int(Isa::kAvx512));
static_assert(int(wire::BACKEND_NATIVE) == int(Backend::kNative) &&
              int(wire::BACKEND_OPENCL) == int(Backend::kOpenCl) &&
              int(wire::BACKEND_AUTO) == int(Backend::kAuto));

wire::Isa encode(Isa isa) { return wire::Isa(isa); }

void encode(const DeviceOptions& options, wire::DeviceOptions& message) {
  message.set_backend(wire::Backend(options.backend));
  message.set_isa(encode(options.isa));
  message.set_threads(options.threads);
  message.set_block_of_one(options.block_of_one);
  message.set_opencl_device(wire_text(options.opencl_device, kLongestText));
}

Expected<DeviceOptions> decode(const wire::DeviceOptions& message) {
  DeviceOptions options;
  if (!wire::Backend_IsValid(message.backend()))
    return fail(fmt::format("the job asks for the unknown backend {}", int(message.backend())));
  if (!wire::Isa_IsValid(message.isa()))
    return fail(fmt::format("the job asks for the unknown instruction set {}", int(message.isa())));
  options.backend = Backend(message.backend());
  options.isa = Isa(message.isa());
  if (message.threads() < 1 || message.threads() > 4096) {
    return fail(fmt::format("the job asks for {} threads; 1 to 4096 make sense", message.threads()));
  }
  options.threads = message.threads();
  options.block_of_one = message.block_of_one();
  options.opencl_device = message.opencl_device();
  return options;
}

void encode(const DevicePreparation& preparation, wire::Ready& message) {
  for (const std::string& warning : preparation.warnings)
    if (message.warnings_size() < kMostWarnings) message.add_warnings(wire_text(warning, kLongestText));
  if (!preparation.kernels) return;
  message.mutable_kernels()->set_cached(preparation.kernels->cached);
  message.mutable_kernels()->set_seconds(preparation.kernels->seconds);
  message.mutable_kernels()->set_note(wire_text(preparation.kernels->note, kLongestText));
}

Expected<DevicePreparation> decode(const wire::Ready& message) {
  if (message.warnings_size() > kMostWarnings)
    return fail(
        fmt::format("a worker with {} warnings; {} make sense", message.warnings_size(), kMostWarnings));
  DevicePreparation preparation;
  for (const std::string& warning : message.warnings())
    preparation.warnings.push_back(wire_text(warning, kLongestText));
  if (!message.has_kernels()) return preparation;
  if (!is_time(message.kernels().seconds()))
    return fail("the time for the kernels is negative or not finite");
  preparation.kernels = KernelOrigin{.cached = message.kernels().cached(),
                                     .seconds = message.kernels().seconds(),
                                     .note = wire_text(message.kernels().note(), kLongestText)};
  return preparation;
}

void encode(const UnitId& id, std::uint32_t view, wire::UnitId& message) {
  message.set_job(id.job);
  message.set_phase(id.phase);
  message.set_pass(id.pass);
  message.set_tile(id.tile);
  message.set_view(view);
}

UnitId decode(const wire::UnitId& message) {
  return {.job = message.job(), .phase = message.phase(), .pass = message.pass(), .tile = message.tile()};
}

void encode(const RenderUnit& unit, wire::Unit& message) {
  wire::PixelUnit& pixels = *message.mutable_pixels();
#define SET_FIELD(type, name) pixels.set_##name(unit.name);
  UNIT_FIELDS(SET_FIELD)
#undef SET_FIELD
}

Expected<RenderUnit> decode(const wire::Unit& message) {
  if (!message.has_pixels()) return fail("a unit of a kind that this program does not know");
  const wire::PixelUnit& pixels = message.pixels();
  const auto is_side = [](int length) { return length >= 1 && length <= kMaxTile; };
  if (!is_side(pixels.width()) || !is_side(pixels.height())) {
    return fail(fmt::format("a unit of {} x {} pixels; 1 to {} a side make sense", pixels.width(),
                            pixels.height(), kMaxTile));
  }
  if (pixels.sample_count() < 1 || pixels.sample_count() > kMaxSamplesPerUnit) {
    return fail(
        fmt::format("a unit of {} samples; 1 to {} make sense", pixels.sample_count(), kMaxSamplesPerUnit));
  }
  if (pixels.spp() != 0 && std::uint64_t(pixels.first_sample()) + pixels.sample_count() > pixels.spp()) {
    return fail(fmt::format("a unit of samples {} to {} of a sequence of {}", pixels.first_sample(),
                            std::uint64_t(pixels.first_sample()) + pixels.sample_count() - 1, pixels.spp()));
  }
#define TAKE_FIELD(type, name) .name = pixels.name(),
  return RenderUnit{UNIT_FIELDS(TAKE_FIELD)};
#undef TAKE_FIELD
}

void encode(const AssetManifest& manifest, wire::AssetManifest& message) {
  for (const AssetPiece& piece : manifest.pieces) {
    wire::AssetPiece& part = *message.add_pieces();
    part.set_hash(piece.hash);
    part.set_size(piece.size);
  }
}

Expected<AssetManifest> decode(const wire::AssetManifest& message, const std::string& hash) {
  AssetManifest manifest{.hash = hash, .pieces = {}};
  for (const wire::AssetPiece& piece : message.pieces()) {
    if (piece.size() < 1 || piece.size() > kLargestPiece)
      return fail(fmt::format("the list of an asset's pieces has one of {} bytes; 1 to {} make sense",
                              piece.size(), kLargestPiece));
    if (!is_content_hash(piece.hash()))
      return fail("the list of an asset's pieces has one whose name is no hash");
    manifest.pieces.push_back({piece.hash(), std::size_t(piece.size())});
  }
  if (const std::string received = hash_of_pieces(manifest.pieces); received != hash)
    return fail(fmt::format("the list of an asset's pieces is damaged: its hash is {} instead of {}",
                            received, hash));
  return manifest;
}

void encode(const View& view, wire::View& message) {
  for (const float value : as_floats(view.camera)) message.add_camera(value);
  for (const float value : as_floats(view.adjustable)) message.add_adjustable(value);
}

Expected<View> decode(const wire::View& message) {
  View view;
  if (Expected<void> taken = take_floats(message.camera(), "camera", view.camera); !taken)
    return std::unexpected(taken.error());
  if (Expected<void> taken = take_floats(message.adjustable(), "adjustable", view.adjustable); !taken)
    return std::unexpected(taken.error());
  if (const char* field = non_finite_field(view))
    return fail(fmt::format("a view whose {} is not finite", field));
  return view;
}

}  // namespace penumbra
