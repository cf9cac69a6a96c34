// The quantities' source for an OpenCL compiler, compiled into the binary.
#pragma once

#include <span>

#include "worker/embedded_kernels.h"

namespace penumbra::stress {

/// quantities.cl and what it includes from this folder, as they are.
std::span<const EmbeddedFile> embedded_quantities();

}  // namespace penumbra::stress
