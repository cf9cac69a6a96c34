// What a process has had of the machine's memory.
#pragma once

#include <cstdint>

namespace penumbra {

/// The most bytes that this process has had resident; 0 if the system does not say. (ru_maxrss of getrusage
/// is no answer: it keeps what the process had between fork and exec, which is all of its parent's memory.)
std::uint64_t peak_memory_bytes();

}  // namespace penumbra
