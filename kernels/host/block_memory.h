// The memory of a block of paths on the host.
#pragma once

#include <cstddef>
#include <cstdint>

#include "kernels/block/path_state.h"
#include "kernels/host/cache_aligned.h"

namespace penumbra {

/// Arrays start at cache lines if the capacities are multiples of 16.
class BlockMemory {
 public:
  /// For scenes with these FEATURE_* bits: `capacity` paths under way, and slots for `slot_capacity` samples.
  BlockMemory(std::uint64_t features, int capacity, int slot_capacity)
      : paths_(std::size_t(path_words(features)) * std::size_t(capacity)),
        slots_(std::size_t(slot_words(features)) * std::size_t(slot_capacity)),
        features_(features),
        capacity_(capacity),
        slot_capacity_(slot_capacity) {}

  [[nodiscard]] Block block() {
    return make_block(features_, paths_.data(), capacity_, slots_.data(), slot_capacity_);
  }

 private:
  AlignedVector<uint> paths_;  // zeros: unused lanes contain finite values, too
  AlignedVector<uint> slots_;
  std::uint64_t features_;
  int capacity_, slot_capacity_;
};

}  // namespace penumbra
