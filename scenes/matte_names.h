// The names of a scene's mattes. A matte is a pair of an object and a material that camera rays can hit
// (Cryptomatte).
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace penumbra {

/// Matte number k of a device scene, counted from 1, is `mattes[k - 1]`. Each name is listed once, so objects
/// of the same name share a matte ID.
struct MatteNames {
  struct Matte {
    std::uint32_t object = 0, material = 0;  ///< indices into the lists of names
    friend bool operator==(const Matte&, const Matte&) = default;
  };
  std::vector<std::string> objects, materials;
  std::vector<Matte> mattes;

  friend bool operator==(const MatteNames&, const MatteNames&) = default;
};

}  // namespace penumbra
