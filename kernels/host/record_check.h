// What the checks of device scenes share.
#pragma once

#include <cstdint>
#include <string>

#include "kernels/host/device_scene.h"

namespace penumbra {

/// Keeps the first problem that is found. The scene must outlive it.
class RecordCheck {
 public:
  explicit RecordCheck(const DeviceScene& scene) : scene_(scene), h_(scene.header) {}

  /// Empty: there is none.
  [[nodiscard]] const std::string& problem() const { return problem_; }

 protected:
  void require(bool ok, const char* what) {
    if (!ok && problem_.empty()) problem_ = what;
  }
  static bool in(int value, int low, int high) { return value >= low && value <= high; }
  /// Whether the mask has the bit with that number.
  static bool holds(std::uint64_t mask, int number) {
    return in(number, 0, 63) && (mask >> number & 1u) != 0;
  }
  [[nodiscard]] bool has(std::uint64_t feature) const { return (h_.features & feature) != 0; }

  const DeviceScene& scene_;
  const SceneHeader& h_;
  std::string problem_;
};

}  // namespace penumbra
