// Where and when a program runs, for statistics and reports.
#pragma once

#include <string>

namespace penumbra {

/// Now, as "2024-06-11T17:03:00Z".
std::string utc_now();

/// Of this machine, or empty.
std::string host_name();

}  // namespace penumbra
