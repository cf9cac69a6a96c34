// The format of a checkpoint: the identity of a render and its merged state.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "kernels/host/error.h"
#include "scheduler/farm/checkpoint_sink.h"

namespace penumbra {

/// Everything on which the samples of a render and the state of its film depend. Renders with equal
/// identities can resume from each other's checkpoints.
struct RenderIdentity {
  std::string version;                                        ///< of this program
  std::string worker;                                         ///< hash of the worker's executable
  std::string scene;                                          ///< content hash of the device scene
  std::vector<std::pair<std::string, std::string>> settings;  ///< names and values; also shown to users

  friend bool operator==(const RenderIdentity&, const RenderIdentity&) = default;
};

/// The identity as text with every byte of it, for hashing.
std::string identity_text(const RenderIdentity& identity);

/// How the render of a checkpoint differs from the requested one, in one line; empty if it does not.
std::string identity_difference(const RenderIdentity& there, const RenderIdentity& asked);

/// Serialises into `bytes`, replacing its contents but reusing its memory. The checksum is not computed yet,
/// because that takes time.
void encode_checkpoint(const RenderIdentity& identity, const Merge& merge, Seconds rendered,
                       std::vector<std::uint8_t>& bytes);
/// Adds the checksum.
void seal_checkpoint(std::vector<std::uint8_t>& bytes);

/// `empty` is the job's merge without results. Errors: not a checkpoint, another format, damaged, of another
/// render (with the difference).
Expected<ResumedState> decode_checkpoint(std::span<const std::uint8_t> bytes, const RenderIdentity& identity,
                                         Merge empty);

}  // namespace penumbra
