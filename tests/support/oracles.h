// Third-party references in ../shared/oracles, a folder beside the repository that is not part of it.
#pragma once

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

namespace penumbra {

/// A file or folder of the references, e.g. "bitterli/cornell-box"; nothing where it is not there.
inline std::optional<std::filesystem::path> find_oracle(const std::string& name) {
  const auto path = std::filesystem::path(PENUMBRA_SOURCE_DIR) / "../shared/oracles" / name;
  if (!std::filesystem::exists(path)) return std::nullopt;
  return path;
}

/// Whether every check has to be made: a run that skips its references proves little.
inline bool is_continuous_integration() {
  const char* ci = std::getenv("CI");
  return ci != nullptr && std::string_view(ci) == "true";
}

}  // namespace penumbra

/// Ends a test that needs this reference where it is not there: skipped, or failed where CI=true.
#define PENUMBRA_NEED_ORACLE(name)                                                                \
  do {                                                                                            \
    if (!::penumbra::find_oracle(name)) {                                                         \
      if (::penumbra::is_continuous_integration())                                                \
        FAIL() << "../shared/oracles/" << (name) << " is not here, and CI=true asks for it";      \
      GTEST_SKIP() << "the third-party reference ../shared/oracles/" << (name) << " is not here"; \
    }                                                                                             \
  } while (false)
