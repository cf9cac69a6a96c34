// PLY files of one mesh in every encoding, for tests.
#pragma once

#include <algorithm>
#include <bit>
#include <cstring>
#include <sstream>
#include <string>

#include "scenes/scene_description.h"

namespace penumbra {

enum class PlyEncoding { kAscii, kLittleEndian, kBigEndian };

class PlyWriter {
 public:
  explicit PlyWriter(PlyEncoding encoding) : encoding_(encoding) {}

  template <typename T>
  void put(T value) {
    if (encoding_ == PlyEncoding::kAscii) {
      body_ << +value << ' ';
      return;
    }
    char bytes[sizeof(T)];
    std::memcpy(bytes, &value, sizeof(T));
    const bool little = std::endian::native == std::endian::little;
    if (little != (encoding_ == PlyEncoding::kLittleEndian)) std::reverse(bytes, bytes + sizeof(T));
    body_.write(bytes, sizeof(T));
  }
  void end_element() {
    if (encoding_ == PlyEncoding::kAscii) body_ << '\n';
  }

  /// The whole file; `header` is what comes between the format and end_header.
  [[nodiscard]] std::string file(const std::string& header) const {
    static constexpr const char* kNames[] = {"ascii", "binary_little_endian", "binary_big_endian"};
    return std::string("ply\nformat ") + kNames[int(encoding_)] + " 1.0\n" + header + "end_header\n" +
           body_.str();
  }

 private:
  PlyEncoding encoding_;
  std::ostringstream body_;
};

/// A square of two triangles (as one quad) with normals and texture coordinates, its properties in an odd
/// order and of odd types, between elements and properties that mean nothing.
inline std::string odd_square_ply(PlyEncoding encoding) {
  PlyWriter ply(encoding);
  const std::string header =
      "comment made for a test\nobj_info none\n"
      "element material 2\nproperty uchar red\nproperty list uchar short weights\n"
      "element vertex 4\nproperty double z\nproperty float s\nproperty uchar flag\nproperty float "
      "x\nproperty int y\n"
      "property float32 t\nproperty float nx\nproperty float ny\nproperty float nz\n"
      "element face 1\nproperty short group\nproperty list ushort uint vertex_index\nproperty list char "
      "float extra\n"
      "element edge 1\nproperty int a\n";
  for (int i = 0; i < 2; ++i) {
    ply.put(std::uint8_t(200));
    ply.put(std::uint8_t(2));
    ply.put(std::int16_t(-3));
    ply.put(std::int16_t(4));
    ply.end_element();
  }
  for (int i = 0; i < 4; ++i) {
    const int x = i == 1 || i == 2, y = i >= 2;
    ply.put(0.125);
    ply.put(float(x));
    ply.put(std::uint8_t(7));
    ply.put(float(x) * 0.5f);
    ply.put(std::int32_t(-y));
    ply.put(float(y));
    ply.put(0.0f);
    ply.put(0.0f);
    ply.put(-1.0f);
    ply.end_element();
  }
  ply.put(std::int16_t(-1));
  ply.put(std::uint16_t(4));
  for (std::uint32_t i = 0; i < 4; ++i) ply.put(i);
  ply.put(std::int8_t(1));
  ply.put(9.5f);
  ply.end_element();
  ply.put(std::int32_t(5));
  ply.end_element();
  return ply.file(header);
}

}  // namespace penumbra
