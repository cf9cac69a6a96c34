// Reads by code that is not trusted with damaged input, such as a library's, in a copy of this process:
// what it does to memory, or that it never ends, is the copy's end alone.
#pragma once

#include <cstdint>
#include <functional>
#include <span>

#include "kernels/host/error.h"

namespace penumbra {

struct ChildLimits {
  std::uint64_t memory_bytes = 0;  ///< beyond what this process has
  unsigned cpu_seconds = 0;        ///< of processor time
};

/// Not under a sanitizer, whose own memory would count.
bool limits_child_memory();

/// In the child: writes to the parent. Returns whether it still reads.
using ChildOutput = std::function<bool(std::span<const std::uint8_t>)>;
/// In the parent: reads as many bytes as there is room for. Returns whether the child wrote so many.
using ChildInput = std::function<bool(std::span<std::uint8_t>)>;

/// Calls `work` in a forked child without its standard output and error, and meanwhile `take`, which reads
/// what the child writes. Other threads do not exist in the child: `work` must wait for none of them.
/// Errors: that of `work`, cut to 4000 bytes; no process; a signal or a limit ended the child, or its doing
/// nothing for far longer than the limit; it wrote more than `take` read; that of `take`, if the child has
/// none.
Expected<void> run_limited(const ChildLimits& limits,
                           const std::function<Expected<void>(const ChildOutput&)>& work,
                           const std::function<Expected<void>(const ChildInput&)>& take);

}  // namespace penumbra
