// Properties of the machine and the time, for statistics and reports.
#pragma once

#include <string>

#include "kernels/host/process.h"

namespace penumbra {

/// The current time, as "2024-06-11T17:03:00Z".
std::string utc_now();

}  // namespace penumbra
