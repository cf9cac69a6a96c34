// Who is seen in a pixel: objects and what they are made of, by name.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace penumbra {

/// Number k of a device scene's owners, from 1 on, is `owners[k - 1]`. Each name is there once, so objects
/// that are called the same are one.
struct OwnerNames {
  struct Owner {
    std::uint32_t object = 0, material = 0;  ///< indices of their names
    friend bool operator==(const Owner&, const Owner&) = default;
  };
  std::vector<std::string> objects, materials;
  std::vector<Owner> owners;

  friend bool operator==(const OwnerNames&, const OwnerNames&) = default;
};

}  // namespace penumbra
