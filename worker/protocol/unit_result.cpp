#include "worker/protocol/unit_result.h"

#include <fmt/format.h>
#include <xxhash.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <span>
#include <utility>
#include <vector>

namespace penumbra {
namespace {

static_assert(std::endian::native == std::endian::little, "sample values travel as little-endian floats");

template <typename T>
std::span<const std::uint8_t> raw_bytes(const std::vector<T>& values, std::size_t begin = 0) {
  return {reinterpret_cast<const std::uint8_t*>(values.data() + begin), (values.size() - begin) * sizeof(T)};
}

std::uint64_t checksum_of(const SampleBuffer& buffer) {
  const auto values = raw_bytes(buffer.values), mattes = raw_bytes(buffer.mattes);
  const std::uint64_t of_values = XXH3_64bits(values.data(), values.size());
  return mattes.empty() ? of_values : XXH3_64bits_withSeed(mattes.data(), mattes.size(), of_values);
}

/// The largest number of mattes of a pixel.
std::size_t most_mattes(std::uint32_t sample_count) {
  return 1 + 2 * std::size_t(matte_pairs(int(sample_count)));
}

/// Ends the hash of a buffer whose values and mattes have been added.
std::uint64_t end_of_hash(ContentHasher& hasher, const SampleBuffer& buffer) {
  std::vector<std::uint64_t> rest = {buffer.values.size(), buffer.mattes.size()};
  // Without the source of flagged samples, which a worker may or may not know.
  for (const FlaggedSamples& kind : buffer.flagged)
    rest.insert(rest.end(), {kind.count, std::uint64_t(kind.x), std::uint64_t(kind.y), kind.sample,
                             std::uint64_t(kind.shape)});
  hasher.add(raw_bytes(rest));
  const ContentDigest digest = hasher.digest();
  std::uint64_t hash = 0;
  std::memcpy(&hash, digest.data(), sizeof hash);
  return hash;
}

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

/// What follows after these numbers of values and mattes, and what is said once.
void encode_rest(const SampleBuffer& buffer, std::size_t values, std::size_t mattes,
                 wire::PixelResult& message) {
  message.Clear();
  message.set_width(buffer.width);
  message.set_height(buffer.height);
  message.set_planes(buffer.planes);
  message.set_sample_count(buffer.sample_count);
  for (const FlaggedSamples& samples : buffer.flagged) encode(samples, *message.add_flagged());
  const auto bytes = raw_bytes(buffer.values, values);
  message.set_values(bytes.data(), bytes.size());
  message.mutable_mattes()->Add(buffer.mattes.begin() + std::ptrdiff_t(mattes), buffer.mattes.end());
  message.set_checksum(checksum_of(buffer));
}

}  // namespace

void encode(const SampleBuffer& buffer, wire::UnitResult& message) {
  encode_rest(buffer, 0, 0, *message.mutable_pixels());
}

Expected<SampleBuffer> decode(const wire::UnitResult& message, const RenderUnit& unit,
                              const FilmLayers& layers) {
  return ResultAssembly(unit, layers).finish(message);
}

std::uint64_t result_hash(const SampleBuffer& buffer) {
  ContentHasher hasher;
  hasher.add(raw_bytes(buffer.values));
  hasher.add(raw_bytes(buffer.mattes));
  return end_of_hash(hasher, buffer);
}

std::size_t result_bytes(const RenderUnit& unit, const FilmLayers& layers) {
  const std::size_t mattes = layers.mattes() > 0 ? most_mattes(unit.sample_count) : 0;
  return std::size_t(unit.width) * std::size_t(unit.height) *
         (std::size_t(layers.planes()) * sizeof(float) + mattes * sizeof(std::uint32_t));
}

// --- Sending

bool ResultCutter::next(std::size_t most_bytes, wire::WorkerMessage& message) {
  constexpr std::size_t kSize = sizeof(float);
  static_assert(kSize == sizeof(std::uint32_t));
  const std::size_t values_left = buffer_.values.size() - values_,
                    mattes_left = buffer_.mattes.size() - mattes_;
  const std::size_t most = most_bytes / kSize;
  if (values_left + mattes_left <= most) {
    *message.mutable_result()->mutable_id() = id_;
    encode_rest(buffer_, values_, mattes_, *message.mutable_result()->mutable_pixels());
    return true;
  }
  wire::ResultPart& part = *message.mutable_part();
  part.Clear();
  *part.mutable_id() = id_;
  const std::size_t values = std::min(values_left, most), mattes = most - values;
  part.set_values(buffer_.values.data() + values_, values * kSize);
  const auto first = buffer_.mattes.begin() + std::ptrdiff_t(mattes_);
  part.mutable_mattes()->Add(first, first + std::ptrdiff_t(mattes));
  values_ += values;
  mattes_ += mattes;
  return false;
}

// --- Receiving

ResultAssembly::ResultAssembly(const RenderUnit& unit, const FilmLayers& layers)
    : unit_(unit),
      layers_(layers),
      buffer_{.width = unit.width,
              .height = unit.height,
              .planes = layers.planes(),
              .sample_count = unit.sample_count,
              .flagged = {},
              .values = {},
              .mattes = {}} {}

Expected<void> ResultAssembly::add(const wire::ResultPart& part) {
  const std::size_t size = part.values().size() + std::size_t(part.mattes_size()) * sizeof(std::uint32_t);
  if (size == 0) return fail("a part of the result is empty");
  if (size > kMostPartBytes)
    return fail(
        fmt::format("a part of the result has {} bytes; at most {} are allowed", size, kMostPartBytes));
  return add(part.values(), part.mattes());
}

Expected<void> ResultAssembly::add(const std::string& values,
                                   const google::protobuf::RepeatedField<std::uint32_t>& mattes) {
  const std::size_t before = buffer_.values.size(), bytes = before * sizeof(float) + values.size();
  if (bytes > value_count() * sizeof(float) || values.size() % sizeof(float) != 0)
    return fail(fmt::format("the result has {} bytes of samples instead of {}", bytes,
                            value_count() * sizeof(float)));
  if (!values.empty()) {
    if (!buffer_.mattes.empty()) return fail("the result has samples after its mattes");
    buffer_.values.reserve(value_count());  // memory is taken only as it is filled
    buffer_.values.resize(bytes / sizeof(float));
    std::memcpy(buffer_.values.data() + before, values.data(), values.size());
    hasher_.add(raw_bytes(buffer_.values, before));
    // Reported only if the bytes are those that were sent.
    if (statistics_) statistics_ = check_statistics(buffer_, before, buffer_.values.size());
  }
  if (mattes.empty()) return {};
  if (layers_.mattes() == 0) return fail("the result has mattes, of which the scene has none");
  if (buffer_.values.size() < value_count())
    return fail(fmt::format("the result has mattes after {} bytes of samples; there must be {}", bytes,
                            value_count() * sizeof(float)));
  const std::size_t matte = buffer_.mattes.size();
  if (matte + std::size_t(mattes.size()) > buffer_.pixels() * most_mattes(unit_.sample_count))
    return fail("the result has mattes of more pixels than there are");
  buffer_.mattes.insert(buffer_.mattes.end(), mattes.begin(), mattes.end());
  hasher_.add(raw_bytes(buffer_.mattes, matte));
  return {};
}

Expected<SampleBuffer> ResultAssembly::finish(const wire::UnitResult& result) {
  if (!result.has_pixels()) return fail("the result is of another kind than its unit");
  const wire::PixelResult& message = result.pixels();
  if (message.width() != unit_.width || message.height() != unit_.height ||
      message.planes() != buffer_.planes || message.sample_count() != unit_.sample_count) {
    return fail(
        fmt::format("the result has {} x {} pixels, {} planes and {} samples instead of {} x {}, {} and {}",
                    message.width(), message.height(), message.planes(), message.sample_count(), unit_.width,
                    unit_.height, buffer_.planes, unit_.sample_count));
  }
  if (!(std::isfinite(result.busy_seconds()) && result.busy_seconds() >= 0))
    return fail("the time for the result is negative or not finite");
  if (message.flagged_size() != BAD_KINDS)
    return fail(fmt::format("the result has {} kinds of flagged samples instead of {}",
                            message.flagged_size(), int(BAD_KINDS)));
  for (int kind = 0; kind < BAD_KINDS; ++kind) {
    const Expected<FlaggedSamples> samples = decode(message.flagged(kind), unit_);
    if (!samples) return std::unexpected(samples.error());
    buffer_.flagged[std::size_t(kind)] = *samples;
  }
  if (const Expected<void> added = add(message.values(), message.mattes()); !added)
    return std::unexpected(added.error());
  if (buffer_.values.size() != value_count())
    return fail(fmt::format("the result has {} bytes of samples instead of {}",
                            buffer_.values.size() * sizeof(float), value_count() * sizeof(float)));
  if (message.checksum() != checksum_of(buffer_))
    return fail("the result's checksum does not match its bytes");
  if (!statistics_) return fail("the result has " + statistics_.error().message);
  if (const Expected<void> checked = check_mattes(buffer_, layers_.mattes()); !checked)
    return fail("the result has " + checked.error().message);
  hash_ = end_of_hash(hasher_, buffer_);
  return std::move(buffer_);
}

}  // namespace penumbra
