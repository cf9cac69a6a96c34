// The source of the quantities for OpenCL compilers, embedded in the binary.
#pragma once

#include <span>

#include "worker/embedded_kernels.h"

namespace penumbra::stress {

/// quantities.cl and the files of this folder that it includes, unchanged.
std::span<const EmbeddedFile> embedded_quantities();

}  // namespace penumbra::stress
