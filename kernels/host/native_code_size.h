// How large the precompiled native kernels are, as the build measured it.
#pragma once

#include <cstdint>

#include "kernels/host/native_kernels.h"

namespace penumbra {

/// Bytes of machine code and constants of the kernel's object file.
std::uint64_t native_code_bytes(const NativeKernel& kernel);

}  // namespace penumbra
