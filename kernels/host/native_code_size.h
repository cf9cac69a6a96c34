// Size of the precompiled native kernels, as measured by the build.
#pragma once

#include <cstdint>

#include "kernels/host/native_kernels.h"

namespace penumbra {

/// Bytes of machine code and constants in the kernel's object file.
std::uint64_t native_code_bytes(const NativeKernel& kernel);

}  // namespace penumbra
