#include "scheduler/protocol/wire.h"

#include <fmt/format.h>
#include <xxhash.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

#include "scheduler/protocol/content_hash.h"
#include "scheduler/protocol/text.h"

namespace penumbra {
namespace {

static_assert(std::endian::native == std::endian::little, "sample values travel as little-endian floats");

bool is_time(double seconds) { return std::isfinite(seconds) && seconds >= 0; }

std::uint64_t checksum_of(const wire::PixelResult& result) {
  const std::uint64_t of_values = XXH3_64bits(result.values().data(), result.values().size());
  const auto& mattes = result.mattes();
  if (mattes.empty()) return of_values;
  return XXH3_64bits_withSeed(mattes.data(), std::size_t(mattes.size()) * sizeof(std::uint32_t), of_values);
}

template <typename T, std::size_t kSize>
std::span<const std::uint8_t> bytes_of(std::span<T, kSize> values) {
  return {reinterpret_cast<const std::uint8_t*>(values.data()), values.size_bytes()};
}

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

wire::Isa encode(Isa isa) {
  switch (isa) {
    case Isa::kSse2:
      return wire::ISA_SSE2;
    case Isa::kAvx2:
      return wire::ISA_AVX2;
    case Isa::kAvx512:
      return wire::ISA_AVX512;
  }
  return wire::ISA_SSE2;
}

wire::Backend encode(Backend backend) {
  switch (backend) {
    case Backend::kNative:
      return wire::BACKEND_NATIVE;
    case Backend::kOpenCl:
      return wire::BACKEND_OPENCL;
    case Backend::kAuto:
      return wire::BACKEND_AUTO;
  }
  return wire::BACKEND_NATIVE;
}

void encode(const DeviceOptions& options, wire::DeviceOptions& message) {
  message.set_backend(encode(options.backend));
  message.set_isa(encode(options.isa));
  message.set_threads(options.threads);
  message.set_block_of_one(options.block_of_one);
  message.set_opencl_device(wire_text(options.opencl_device, kLongestText));
}

Expected<DeviceOptions> decode(const wire::DeviceOptions& message) {
  DeviceOptions options;
  switch (message.backend()) {
    case wire::BACKEND_NATIVE:
      options.backend = Backend::kNative;
      break;
    case wire::BACKEND_OPENCL:
      options.backend = Backend::kOpenCl;
      break;
    case wire::BACKEND_AUTO:
      options.backend = Backend::kAuto;
      break;
    default:
      return fail(fmt::format("the job asks for the unknown backend {}", int(message.backend())));
  }
  switch (message.isa()) {
    case wire::ISA_SSE2:
      options.isa = Isa::kSse2;
      break;
    case wire::ISA_AVX2:
      options.isa = Isa::kAvx2;
      break;
    case wire::ISA_AVX512:
      options.isa = Isa::kAvx512;
      break;
    default:
      return fail(fmt::format("the job asks for the unknown instruction set {}", int(message.isa())));
  }
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

namespace {

void encode(const FlaggedSamples& samples, wire::FlaggedSamples& message) {
  message.set_count(samples.count);
  message.set_x(samples.x);
  message.set_y(samples.y);
  message.set_sample(samples.sample);
  message.set_source(samples.source.where);
  message.set_step(samples.source.step);
  message.set_shape(samples.shape);
}

/// Errors: values that are impossible for a result of the unit.
Expected<FlaggedSamples> decode(const wire::FlaggedSamples& message, const RenderUnit& unit) {
  const FlaggedSamples samples{.count = message.count(),
                               .x = message.x(),
                               .y = message.y(),
                               .sample = message.sample(),
                               .source = {message.source(), message.step()},
                               .shape = message.shape()};
  const std::uint64_t all = std::uint64_t(unit.width) * std::uint64_t(unit.height) * unit.sample_count;
  if (samples.count > all)
    return fail(fmt::format("the result counts {} samples of a kind among {}", samples.count, all));
  const bool inside = samples.x >= unit.x && samples.x - unit.x < unit.width && samples.y >= unit.y &&
                      samples.y - unit.y < unit.height &&
                      samples.sample - unit.first_sample < unit.sample_count;
  if (samples.count > 0 && !inside)
    return fail(fmt::format(
        "the result has its first flagged sample at ({}, {}), sample {}, which is not of its unit", samples.x,
        samples.y, samples.sample));
  if (!is_possible(samples))
    return fail("the result has a flagged sample of a source or a shape that cannot be");
  return samples;
}

}  // namespace

void encode(const SampleBuffer& buffer, wire::UnitResult& result) {
  wire::PixelResult& message = *result.mutable_pixels();
  message.Clear();
  message.set_width(buffer.width);
  message.set_height(buffer.height);
  message.set_planes(buffer.planes);
  message.set_sample_count(buffer.sample_count);
  for (const FlaggedSamples& samples : buffer.flagged) encode(samples, *message.add_flagged());
  message.set_values(buffer.values.data(), buffer.values.size() * sizeof(float));
  message.mutable_mattes()->Add(buffer.mattes.begin(), buffer.mattes.end());
  message.set_checksum(checksum_of(message));
}

Expected<SampleBuffer> decode(const wire::UnitResult& result, const RenderUnit& unit,
                              const FilmLayers& layers) {
  const int planes = layers.planes();
  if (!result.has_pixels()) return fail("the result is of another kind than its unit");
  const wire::PixelResult& message = result.pixels();
  if (message.width() != unit.width || message.height() != unit.height || message.planes() != planes ||
      message.sample_count() != unit.sample_count) {
    return fail(
        fmt::format("the result has {} x {} pixels, {} planes and {} samples instead of {} x {}, {} and {}",
                    message.width(), message.height(), message.planes(), message.sample_count(), unit.width,
                    unit.height, planes, unit.sample_count));
  }
  SampleBuffer buffer{.width = unit.width,
                      .height = unit.height,
                      .planes = planes,
                      .sample_count = unit.sample_count,
                      .flagged = {},
                      .values = {},
                      .mattes = {}};
  const std::size_t count = buffer.pixels() * std::size_t(planes);
  if (message.values().size() != count * sizeof(float)) {
    return fail(fmt::format("the result has {} bytes of samples instead of {}", message.values().size(),
                            count * sizeof(float)));
  }
  if (!is_time(result.busy_seconds())) return fail("the time for the result is negative or not finite");
  if (message.flagged_size() != BAD_KINDS)
    return fail(fmt::format("the result has {} kinds of flagged samples instead of {}",
                            message.flagged_size(), int(BAD_KINDS)));
  for (int kind = 0; kind < BAD_KINDS; ++kind) {
    const Expected<FlaggedSamples> samples = decode(message.flagged(kind), unit);
    if (!samples) return std::unexpected(samples.error());
    buffer.flagged[std::size_t(kind)] = *samples;
  }
  if (message.checksum() != checksum_of(message)) {
    return fail("the result's checksum does not match its bytes");
  }
  buffer.values.resize(count);
  std::memcpy(buffer.values.data(), message.values().data(), message.values().size());
  if (const Expected<void> checked = check_statistics(buffer); !checked)
    return fail("the result has " + checked.error().message);
  buffer.mattes.assign(message.mattes().begin(), message.mattes().end());
  if (const Expected<void> checked = check_mattes(buffer, layers.mattes()); !checked)
    return fail("the result has " + checked.error().message);
  return buffer;
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

std::uint64_t result_hash(const wire::UnitResult& message) {
  const wire::PixelResult& pixels = message.pixels();
  std::vector<std::uint64_t> flagged = {std::uint64_t(pixels.flagged_size()),
                                        std::uint64_t(pixels.mattes_size())};
  // Without the source, which a worker may or may not know.
  for (const wire::FlaggedSamples& kind : pixels.flagged())
    flagged.insert(flagged.end(), {kind.count(), std::uint64_t(kind.x()), std::uint64_t(kind.y()),
                                   kind.sample(), std::uint64_t(kind.shape())});
  const std::span mattes(pixels.mattes().data(), std::size_t(pixels.mattes_size()));
  const ContentDigest digest =
      content_digest({bytes_of(std::span(flagged)), bytes_of(mattes), bytes_of(std::span(pixels.values()))});
  std::uint64_t hash = 0;
  std::memcpy(&hash, digest.data(), sizeof hash);
  return hash;
}

}  // namespace penumbra
