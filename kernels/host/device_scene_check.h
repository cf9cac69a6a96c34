// Whether a device scene that came over the wire can be traced without reading outside it.
#pragma once

#include <span>

#include "kernels/host/device_scene.h"

namespace penumbra {

/// The `count` records of a table at word `offset`.
template <typename T>
std::span<const T> table(const DeviceScene& scene, std::uint32_t offset, int count) {
  return {reinterpret_cast<const T*>(scene.words.data() + offset), std::size_t(count)};
}

/// Every table inside the words (one record more than counted where kernels read record 0 unasked), every
/// index inside its table, every enumerated value known.
Expected<void> check_device_scene(const DeviceScene& scene);

}  // namespace penumbra
