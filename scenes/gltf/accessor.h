// Accessors of glTF: arrays of vectors in buffers, of any component type, sparse or not.
#pragma once

#include <cstddef>
#include <vector>

#include "scenes/gltf/asset.h"

namespace penumbra::gltf {

struct AccessorValues {
  std::size_t count = 0;
  std::size_t components = 1;   ///< of each
  std::vector<double> numbers;  ///< normalised, where the accessor is

  [[nodiscard]] double at(std::size_t element, std::size_t component) const {
    return numbers[element * components + component];
  }
};

/// Reads a whole accessor, which has to have `least` to `most` components; with 16 it is of matrices, column
/// by column. Errors: no such accessor, another shape, beyond its buffer, numbers that are not finite, more
/// elements than can be meant.
Expected<AccessorValues> read_accessor(const Asset& asset, int index, std::size_t least, std::size_t most);

/// The same of an accessor whose numbers, as they are stored, were in data that are decompressed.
Expected<AccessorValues> decompressed_accessor(const Asset& asset, int index, std::size_t components,
                                               std::vector<double> numbers, std::size_t least,
                                               std::size_t most);

}  // namespace penumbra::gltf
