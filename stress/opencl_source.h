// The quantities' source for an OpenCL compiler.
#pragma once

#include <span>
#include <string>

#include "worker/embedded_kernels.h"

namespace penumbra::stress {

/// quantities.cl and what it includes from this folder, as they are.
std::span<const EmbeddedFile> embedded_quantities();

/// quantities.cl with all its includes in place.
std::string opencl_quantities();

}  // namespace penumbra::stress
