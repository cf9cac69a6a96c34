// This machine's name.
#pragma once

#include <unistd.h>

#include <string>

namespace penumbra {

/// As the system knows it, or empty.
inline std::string host_name() {
  char name[256] = {};
  return gethostname(name, sizeof name - 1) == 0 ? name : "";
}

}  // namespace penumbra
