// The bytes of a checkpoint: what a render is, and what is merged of it.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "kernels/host/error.h"
#include "scheduler/farm/checkpoint_sink.h"

namespace penumbra {

/// All that the samples of a render depend on, and what the state of its film does. Two renders with equal
/// ones can go on with each other's checkpoints.
struct RenderIdentity {
  std::string version;                                        ///< of this program
  std::string worker;                                         ///< hash of the program that computes
  std::string scene;                                          ///< hash of the scene as workers get it
  std::vector<std::pair<std::string, std::string>> settings;  ///< name and value, for people too

  friend bool operator==(const RenderIdentity&, const RenderIdentity&) = default;
};

/// Every byte of an identity, for hashing.
std::string identity_text(const RenderIdentity& identity);

/// How the render of a checkpoint differs from the one asked for, a line; empty if it does not.
std::string identity_difference(const RenderIdentity& there, const RenderIdentity& asked);

/// Replaces what is in `bytes`, whose memory is used again. Without the checksum, which takes time.
void encode_checkpoint(const RenderIdentity& identity, const Merge& merge, Seconds rendered,
                       std::vector<std::uint8_t>& bytes);
/// Adds what is missing.
void seal_checkpoint(std::vector<std::uint8_t>& bytes);

/// `empty` is the job's, with nothing merged. Errors: no checkpoint, of another format, damaged, of another
/// render (with what differs).
Expected<ResumedState> decode_checkpoint(std::span<const std::uint8_t> bytes, const RenderIdentity& identity,
                                         Merge empty);

}  // namespace penumbra
