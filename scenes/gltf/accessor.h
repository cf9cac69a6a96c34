// Accessors of glTF: arrays of vectors in buffers, of any component type, possibly sparse.
#pragma once

#include <cstddef>
#include <vector>

#include "scenes/gltf/asset.h"

namespace penumbra::gltf {

struct AccessorValues {
  std::size_t count = 0;
  std::size_t components = 1;   ///< components per element
  std::vector<double> numbers;  ///< normalised if the accessor is

  [[nodiscard]] double at(std::size_t element, std::size_t component) const {
    return numbers[element * components + component];
  }
};

/// Reads a whole accessor, which must have `least` to `most` components. With 16 components the elements are
/// matrices in column-major order. Errors: no such accessor, another number of components, data beyond its
/// buffer, numbers that are not finite, implausibly many elements.
Expected<AccessorValues> read_accessor(const Asset& asset, int index, std::size_t least, std::size_t most);

/// The same for an accessor whose stored numbers, `numbers`, have already been decompressed.
Expected<AccessorValues> decompressed_accessor(const Asset& asset, int index, std::size_t components,
                                               std::vector<double> numbers, std::size_t least,
                                               std::size_t most);

}  // namespace penumbra::gltf
