// Two scenes that differ and that XXH3 does not tell apart: what anybody can make for a hash that is not
// collision-resistant.
#pragma once

#include <cstdint>
#include <utility>

#include "tests/support/fake_device.h"

namespace penumbra {

/// XXH3 adds to one sum the product of the halves of (data xor key), and to another the data. Where one half
/// is zero the product is too, whatever the other: then what one stripe of 64 bytes has more there, the next
/// may have less. The keys are words 0 and 2 of XXH3's secret. The words lie at the start of the second
/// piece.
inline std::pair<DeviceScene, DeviceScene> xxh3_twins() {
  DeviceScene one = fake_scene(40, 30, true);
  one.words[0] = 0x396cfeb8u;
  one.words[16] = 0x2c81017cu;
  one.words[1] = one.words[17] = 0x3f800000u;
  DeviceScene other = one;
  ++other.words[1];
  --other.words[17];
  return {one, other};
}

}  // namespace penumbra
