#include "scheduler/cli/build_info.h"

#include <fmt/format.h>

#include "build_commit.h"
#include "scheduler/record/version.h"
#include "worker/device.h"

namespace penumbra {

std::string build_info() {
  return fmt::format(
      "penumbra {}\n"
      "commit:           {}\n"
      "compiler:         {}\n"
      "build:            {}\n"
      "instruction sets: {}; this machine: {}\n"
      "backends:         native, opencl\n"
      "libraries:        {}",
      kVersion, PENUMBRA_COMMIT, PENUMBRA_COMPILER, PENUMBRA_BUILD_TYPE, isa_list(built_isas()),
      isa_name(best_isa()), PENUMBRA_LIBRARIES);
}

}  // namespace penumbra
