// The mattes of a scene by name: a matte is a pair of an object and a material that camera rays can hit
// (Cryptomatte).
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace penumbra {

/// Number k of a device scene's mattes, from 1 on, is `mattes[k - 1]`. Each name is there once, so objects
/// that are called the same are one.
struct MatteNames {
  struct Matte {
    std::uint32_t object = 0, material = 0;  ///< indices of their names
    friend bool operator==(const Matte&, const Matte&) = default;
  };
  std::vector<std::string> objects, materials;
  std::vector<Matte> mattes;

  friend bool operator==(const MatteNames&, const MatteNames&) = default;
};

}  // namespace penumbra
