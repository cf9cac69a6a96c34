// Tunes malloc for results in scheduler and worker processes.
#pragma once

#include <malloc.h>

namespace penumbra {

/// Results have a few hundred kilobytes each and arrive by the thousand. By default the C library maps and
/// unmaps memory for every block of that size, and the page faults cost more than the merge. This makes it
/// keep and reuse such blocks. Call it once, at the start of main.
inline void keep_message_memory() {
  constexpr int kLargestMessage = 64 << 20;
  mallopt(M_MMAP_THRESHOLD, kLargestMessage);
  mallopt(M_TRIM_THRESHOLD, 2 * kLargestMessage);
}

}  // namespace penumbra
