// Parts of the program that are loaded at their first use, since what stands behind them is large.
#pragma once

#include "kernels/host/error.h"

namespace penumbra {

/// The object of that name in a module, which is a file beside the executable, or in ../lib/penumbra from
/// there, or else where the system looks for libraries. It stays loaded. Errors: there is no such file, or no
/// such object in it.
Expected<const void*> load_module(const char* file, const char* object);

}  // namespace penumbra
