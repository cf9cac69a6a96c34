// The result of a unit as messages. Large results come in parts, so that other messages can go in between and
// nobody needs memory for a message of the size of a result.
#pragma once

#include <cstddef>
#include <cstdint>

#include "kernels/host/content_hash.h"
#include "kernels/host/error.h"
#include "kernels/host/sample_buffer.h"
#include "penumbra.pb.h"
#include "worker/protocol/wire.h"

namespace penumbra {

/// The most bytes of samples and mattes in a ResultPart.
constexpr std::size_t kMostPartBytes = std::size_t(1) << 20;

/// The whole buffer in one message: its samples, counts and checksum.
void encode(const SampleBuffer& buffer, wire::UnitResult& message);
/// Errors, in plain words: a wrong checksum, a buffer that does not have the shape of `unit` with these
/// layers, values that are not valid statistics (see check_statistics), invalid mattes (see check_mattes), a
/// time that is not finite.
Expected<SampleBuffer> decode(const wire::UnitResult& message, const RenderUnit& unit,
                              const FilmLayers& layers);

/// Cuts a result into messages: any number of ResultParts, and the UnitResult that ends it.
class ResultCutter {
 public:
  /// Keeps references to both.
  ResultCutter(const wire::UnitId& id, const SampleBuffer& buffer) : id_(id), buffer_(buffer) {}

  /// Sets the next message, with at most `most_bytes`, in [4, kMostPartBytes], of samples and mattes. Returns
  /// whether it is the UnitResult, which is the last one.
  bool next(std::size_t most_bytes, wire::WorkerMessage& message);

 private:
  const wire::UnitId& id_;
  const SampleBuffer& buffer_;
  std::size_t values_ = 0, mattes_ = 0;  // how many are in earlier messages
};

/// Puts the messages of one result together, checking and hashing them as they come. After an error the
/// object must not be used any more.
class ResultAssembly {
 public:
  ResultAssembly(const RenderUnit& unit, const FilmLayers& layers);

  /// Errors: an empty part, too large a part, more samples or mattes than the unit can have, samples after
  /// mattes.
  Expected<void> add(const wire::ResultPart& part);
  /// Takes the message that ends the result. Errors: see decode.
  Expected<SampleBuffer> finish(const wire::UnitResult& message);
  /// After finish: the first 64 bits of a cryptographic digest of everything that must be equal in two
  /// results of one unit. A worker cannot construct a different result with the same hash.
  [[nodiscard]] std::uint64_t hash() const { return hash_; }

 private:
  Expected<void> add(const std::string& values, const google::protobuf::RepeatedField<std::uint32_t>& mattes);
  [[nodiscard]] std::size_t value_count() const { return buffer_.pixels() * std::size_t(buffer_.planes); }

  RenderUnit unit_;
  FilmLayers layers_;
  SampleBuffer buffer_;
  Expected<void> statistics_;  // whether the values so far are valid
  ContentHasher hasher_;
  std::uint64_t hash_ = 0;
};

/// The hash that a ResultAssembly of this buffer has.
std::uint64_t result_hash(const SampleBuffer& buffer);

/// The most bytes of memory that a unit's result takes.
std::size_t result_bytes(const RenderUnit& unit, const FilmLayers& layers);

}  // namespace penumbra
