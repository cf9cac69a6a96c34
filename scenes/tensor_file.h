// Tensor files, of arrays by name: the container of the RGL material database (Dupuy and Jakob 2018).
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "kernels/host/error.h"

namespace penumbra {

struct Tensor {
  std::uint8_t type = 0;             ///< the file's number of it
  std::vector<std::uint64_t> shape;  ///< the last index runs fastest
  std::string_view bytes;            ///< of the file, in little-endian order

  static constexpr std::uint8_t kByte = 1, kFloat = 10;  ///< unsigned, and of single precision
};

/// By their names.
using Tensors = std::map<std::string, Tensor, std::less<>>;

/// The tensors of a file, which point into `bytes`. The file has "tensor_file" and a zero byte; the bytes 1
/// and 0, its version; and the number of fields, in 4 bytes. A field has a name, after its length in 2 bytes;
/// the number of dimensions, in 2; the type, in 1; and in 8 each the offset of its numbers in the file and
/// the sizes. Errors, which begin with `name` and name the field: another format or version, an end before
/// that of a field or of its numbers, an unknown type, a name twice.
Expected<Tensors> read_tensors(const std::string& name, std::string_view bytes);

/// "2 x 8 x 32".
std::string print_shape(const std::vector<std::uint64_t>& shape);

}  // namespace penumbra
