// Shared libraries that are loaded on first use, since they depend on large libraries.
#pragma once

#include "kernels/host/error.h"

namespace penumbra {

/// The object of that name in a module, which stays loaded. The module is a file beside the executable, or in
/// ../lib/penumbra relative to it, or where the system looks for libraries. Errors: no such file, or no such
/// object in it.
Expected<const void*> load_module(const char* file, const char* object);

}  // namespace penumbra
