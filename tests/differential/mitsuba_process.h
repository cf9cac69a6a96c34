// Mitsuba 3 in a child process, which renders one scene after the other.
#pragma once

#include <sys/types.h>

#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <string>
#include <vector>

#include "kernels/host/error.h"
#include "tests/support/image_test.h"

namespace penumbra::differential {

struct MitsubaJob {
  std::filesystem::path scene, image;
  int batches = 0, spp = 0;  ///< samples per pixel of each batch
  std::uint32_t first_seed = 0;
};

class MitsubaProcess {
 public:
  /// By the Python that PENUMBRA_MITSUBA_PYTHON names, else python3. `ready` says whether that has Mitsuba.
  MitsubaProcess();
  MitsubaProcess(const MitsubaProcess&) = delete;
  MitsubaProcess& operator=(const MitsubaProcess&) = delete;
  ~MitsubaProcess();

  /// Whether it can render; why not, otherwise.
  [[nodiscard]] const Expected<void>& ready() const { return ready_; }
  /// Whether the Python was named, so that one without Mitsuba is a mistake.
  [[nodiscard]] bool named() const { return named_; }

  /// Asks for a render; it goes on while this process does something else.
  void start(const MitsubaJob& job);
  /// Waits for the oldest job, and returns its batches.
  Expected<std::vector<statistics::Image>> finish(const MitsubaJob& job);

 private:
  std::string line();

  pid_t pid_ = -1;
  bool named_ = false;
  std::FILE* to_ = nullptr;
  std::FILE* from_ = nullptr;
  Expected<void> ready_;
};

}  // namespace penumbra::differential
