// Two different scenes with the same XXH3 hash. Anybody can make such a pair, because XXH3 is not
// collision-resistant.
#pragma once

#include <cstdint>
#include <cstring>
#include <utility>

#include "kernels/scene_types.h"
#include "tests/support/fake_device.h"

namespace penumbra {

constexpr std::size_t kTwinWords = 40 * sizeof(Triangle) / sizeof(std::uint32_t);

/// XXH3 adds to one sum the product of the halves of (data xor key), and to another the data. Where one half
/// is zero the product is too, whatever the other: then what one stripe of 64 bytes has more there, the next
/// may have less. The keys are words 0 and 2 of XXH3's secret. The last piece of the scenes, their triangles,
/// has kTwinWords words.
inline std::pair<DeviceScene, DeviceScene> xxh3_twins() {
  DeviceScene one = fake_scene(40, 30, true);
  const std::size_t first = one.words.size();
  one.words.resize(first + kTwinWords);
  one.header.tables.triangles = {40, std::uint32_t(first)};
  Triangle triangle{};
  triangle.light = triangle.normals = -1;
  for (std::size_t at = first; at < one.words.size(); at += sizeof triangle / sizeof(std::uint32_t))
    std::memcpy(&one.words[at], &triangle, sizeof triangle);
  // Corners of the first and of the second triangle.
  one.words[first] = 0x396cfeb8u;
  one.words[first + 16] = 0x2c81017cu;
  one.words[first + 1] = one.words[first + 17] = 0x3f800000u;
  DeviceScene other = one;
  ++other.words[first + 1];
  --other.words[first + 17];
  return {one, other};
}

}  // namespace penumbra
