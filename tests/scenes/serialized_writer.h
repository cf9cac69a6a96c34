// Mitsuba's serialized files in every version, for tests.
#pragma once

#include <zlib.h>

#include <cstdint>
#include <cstring>
#include <optional>
#include <string>
#include <vector>

#include "scenes/scene_description.h"

namespace penumbra {

struct SerializedOptions {
  int version = 4;
  bool doubles = false;
  bool face_normals = false;
  bool names_precision = true;  ///< says so if numbers are single
};

class SerializedWriter {
 public:
  explicit SerializedWriter(int version) : version_(version) {}

  void add(const Mesh& mesh, const SerializedOptions& options) {
    std::string data;
    std::uint32_t flags = options.doubles ? 0x2000 : options.names_precision ? 0x1000 : 0;
    flags |= mesh.normals.empty() ? 0 : 0x1;
    flags |= mesh.texcoords.empty() ? 0 : 0x2;
    flags |= mesh.colours.empty() ? 0 : 0x8;
    flags |= options.face_normals ? 0x10 : 0;
    put(data, flags);
    if (version_ >= 4) data += std::string("a n\xc3\xa4me") + '\0';
    put(data, std::uint64_t(mesh.positions.size()));
    put(data, std::uint64_t(mesh.triangles.size()));
    if (options.doubles)
      put_vertices<double>(data, mesh);
    else
      put_vertices<float>(data, mesh);
    for (const glm::uvec3& t : mesh.triangles) put(data, t);
    add_packed(data);
  }

  /// A mesh whose stream unpacks to these bytes.
  void add_packed(const std::string& data) {
    offsets_.push_back(file_.size());
    put(file_, std::uint16_t(0x041c));
    put(file_, std::uint16_t(version_));
    uLongf size = compressBound(uLong(data.size()));
    std::string packed(size, '\0');
    compress(reinterpret_cast<Bytef*>(packed.data()), &size, reinterpret_cast<const Bytef*>(data.data()),
             uLong(data.size()));
    file_ += packed.substr(0, size);
  }

  [[nodiscard]] std::string file() const {
    std::string result = file_;
    for (const std::uint64_t offset : offsets_) {
      if (version_ >= 4)
        put(result, offset);
      else
        put(result, std::uint32_t(offset));
    }
    put(result, std::uint32_t(offsets_.size()));
    return result;
  }

  template <typename T>
  static void put(std::string& to, const T& value) {
    to.append(reinterpret_cast<const char*>(&value), sizeof value);
  }

 private:
  template <typename Number>
  static void put_vertices(std::string& to, const Mesh& mesh) {
    const auto put_all = [&](const auto& vectors) {
      for (const auto& v : vectors)
        for (int k = 0; k < v.length(); ++k) put(to, Number(v[k]));
    };
    put_all(mesh.positions);
    put_all(mesh.normals);
    put_all(mesh.texcoords);
    put_all(mesh.colours);
  }

  int version_;
  std::string file_;
  std::vector<std::uint64_t> offsets_;
};

/// A quadrilateral of two triangles whose last vertex has x = `x`, with everything that vertices may have.
inline Mesh serialized_square(double x) {
  Mesh mesh;
  mesh.positions = {{0, 0, 0.125}, {0.5, 0, 0.125}, {0.5, -1, 0.125}, {x, -1, 0.125}};
  mesh.normals = {{0, 0, -1}, {0, 0, -1}, {0, 0.6f, -0.8f}, {0, 0, -1}};
  mesh.texcoords = {{0, 0}, {1, 0}, {1, 1}, {0, 0.75f}};
  mesh.colours = {{1, 0, 0}, {0, 1, 0}, {0, 0, 2.5f}, {1, 1, 1}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  return mesh;
}

}  // namespace penumbra
