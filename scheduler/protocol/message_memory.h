// How scheduler and worker processes keep memory for results.
#pragma once

#include <malloc.h>

namespace penumbra {

/// Results are a few hundred kilobytes each and come by the thousand. By default the C library maps every
/// block of that size anew and gives it back, and the page faults cost more than the merge; this lets it keep
/// and reuse them. Call once, at the start of main.
inline void keep_message_memory() {
  constexpr int kLargestMessage = 64 << 20;
  mallopt(M_MMAP_THRESHOLD, kLargestMessage);
  mallopt(M_TRIM_THRESHOLD, 2 * kLargestMessage);
}

}  // namespace penumbra
