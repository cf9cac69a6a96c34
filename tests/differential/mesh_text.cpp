#include "tests/differential/mesh_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <numbers>

namespace penumbra::differential {
namespace {

constexpr double kPi = std::numbers::pi;

/// Triangles from the polygons' first corners: right for convex ones.
void fan(Polyhedron& mesh) {
  for (const std::vector<int>& face : mesh.faces)
    for (std::size_t i = 2; i < face.size(); ++i) mesh.triangles.push_back({face[0], face[i - 1], face[i]});
}

/// A corner of a star: every other one is close to the centre.
glm::dvec3 star_corner(int k, int points, double z) {
  const double radius = k % 2 == 0 ? 0.9 : 0.4, angle = kPi * (k + 0.3) / points;
  return {radius * std::cos(angle), radius * std::sin(angle), z};
}

/// A star's triangles over the corners first ... first + 2 points - 1: its tips, and the polygon between
/// them.
void add_star_triangles(std::vector<std::vector<int>>& triangles, int points, int first, bool reverse) {
  const int count = 2 * points;
  const auto add = [&](int a, int b, int c) {
    if (reverse) std::swap(b, c);
    triangles.push_back({first + a, first + b, first + c});
  };
  for (int k = 0; k < count; k += 2) add((k + count - 1) % count, k, k + 1);
  for (int k = 3; k + 2 < count; k += 2) add(1, k, k + 2);
}

}  // namespace

Polyhedron tetrahedron() {
  Polyhedron mesh;
  mesh.positions = {{0.9, 0, -0.3}, {-0.45, 0.75, -0.3}, {-0.45, -0.75, -0.3}, {0, 0, 0.9}};
  mesh.faces = {{0, 1, 3}, {1, 2, 3}, {2, 0, 3}, {0, 2, 1}};
  fan(mesh);
  return mesh;
}

Polyhedron ball(int rows, int columns, double part) {
  Polyhedron mesh;
  for (int r = 0; r <= rows; ++r) {
    const double theta = kPi * (0.02 + 0.96 * part * r / rows);
    for (int c = 0; c < columns; ++c) {
      const double phi = 2 * kPi * c / columns;
      mesh.positions.emplace_back(std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi),
                                  std::cos(theta));
    }
  }
  mesh.normals = mesh.positions;
  for (int r = 0; r < rows; ++r)
    for (int c = 0; c < columns; ++c) {
      const int d = (c + 1) % columns;
      mesh.faces.push_back({r * columns + c, (r + 1) * columns + c, (r + 1) * columns + d, r * columns + d});
    }
  fan(mesh);
  return mesh;
}

Polyhedron ring(int rows, int columns) {
  Polyhedron mesh;
  for (int r = 0; r < rows; ++r) {
    const double theta = 2 * kPi * r / rows;
    for (int c = 0; c < columns; ++c) {
      const double phi = 2 * kPi * c / columns;
      const glm::dvec3 normal(std::cos(theta) * std::cos(phi), std::cos(theta) * std::sin(phi),
                              std::sin(theta));
      mesh.normals.push_back(normal);
      mesh.positions.push_back(glm::dvec3(0.65 * std::cos(phi), 0.65 * std::sin(phi), 0) + 0.3 * normal);
    }
  }
  for (int r = 0; r < rows; ++r)
    for (int c = 0; c < columns; ++c) {
      const int s = (r + 1) % rows, d = (c + 1) % columns;
      mesh.faces.push_back({r * columns + c, r * columns + d, s * columns + d, s * columns + c});
    }
  fan(mesh);
  return mesh;
}

Polyhedron faceted(Polyhedron smooth) {
  smooth.normals.clear();
  return smooth;
}

Polyhedron plate(int corners) {
  Polyhedron mesh;
  mesh.faces.emplace_back();
  for (int k = 0; k < corners; ++k) {
    const double angle = 2 * kPi * k / corners;
    mesh.positions.emplace_back(0.95 * std::cos(angle), 0.95 * std::sin(angle), 0);
    mesh.faces[0].push_back(k);
  }
  fan(mesh);
  return mesh;
}

Polyhedron star(int points) {
  Polyhedron mesh;
  mesh.faces.emplace_back();
  for (int k = 0; k < 2 * points; ++k) {
    mesh.positions.push_back(star_corner(k, points, 0));
    mesh.faces[0].push_back(k);
  }
  add_star_triangles(mesh.triangles, points, 0, false);
  return mesh;
}

Polyhedron star_prism(int points) {
  Polyhedron mesh;
  const int count = 2 * points;
  std::vector<int> top, bottom;
  for (int k = 0; k < count; ++k) {
    mesh.positions.push_back(star_corner(k, points, 0.35));
    top.push_back(k);
  }
  for (int k = 0; k < count; ++k) {
    mesh.positions.push_back(star_corner(k, points, -0.35));
    bottom.insert(bottom.begin(), count + k);
  }
  for (int k = 0; k < count; ++k) {
    const int next = (k + 1) % count;
    mesh.faces.push_back({k, count + k, count + next, next});
  }
  fan(mesh);
  mesh.faces.push_back(top);
  mesh.faces.push_back(bottom);
  add_star_triangles(mesh.triangles, points, 0, false);
  add_star_triangles(mesh.triangles, points, count, true);
  return mesh;
}

std::string obj_text(const Polyhedron& mesh, bool triangles, bool from_end, bool texcoords) {
  const bool normals = !mesh.normals.empty();
  std::string text = "# a mesh\no thing\n";
  for (const glm::dvec3& p : mesh.positions) text += fmt::format("v {:.9g} {:.9g} {:.9g}\n", p.x, p.y, p.z);
  if (texcoords) {
    for (const glm::dvec3& p : mesh.positions) text += fmt::format("vt {:.9g} {:.9g}\n", p.x, p.y);
  }
  for (const glm::dvec3& n : mesh.normals) text += fmt::format("vn {:.9g} {:.9g} {:.9g}\n", n.x, n.y, n.z);
  text += "s 1\n";
  for (const std::vector<int>& face : triangles ? mesh.triangles : mesh.faces) {
    text += "f";
    for (const int k : face) {
      const int index = from_end ? k - int(mesh.positions.size()) : k + 1;
      text += fmt::format(" {}", index);
      if (texcoords) text += fmt::format("/{}", index);
      if (normals) text += fmt::format("{}/{}", texcoords ? "" : "/", index);
    }
    text += "\n";
  }
  return text;
}

namespace {

enum class PlyFormat { kText, kLittleEndian, kBigEndian };

template <typename T>
void put(std::string& out, PlyFormat format, T value) {
  if (format == PlyFormat::kText) {
    out += fmt::format("{} ", value);
    return;
  }
  std::array<char, sizeof(T)> bytes = std::bit_cast<std::array<char, sizeof(T)>>(value);
  if ((format == PlyFormat::kLittleEndian) != (std::endian::native == std::endian::little))
    std::ranges::reverse(bytes);
  out.append(bytes.data(), bytes.size());
}

}  // namespace

std::string ply_text(const Polyhedron& mesh, bool triangles, Random& random) {
  const PlyFormat format = random.one_of({PlyFormat::kText, PlyFormat::kLittleEndian, PlyFormat::kBigEndian});
  const bool normals = !mesh.normals.empty();
  const auto& faces = triangles ? mesh.triangles : mesh.faces;
  std::string text = fmt::format("ply\nformat {} 1.0\ncomment a mesh\nelement vertex {}\n",
                                 format == PlyFormat::kText           ? "ascii"
                                 : format == PlyFormat::kLittleEndian ? "binary_little_endian"
                                                                      : "binary_big_endian",
                                 mesh.positions.size());
  for (const char* name : {"x", "y", "z"}) text += fmt::format("property float {}\n", name);
  if (normals) {
    for (const char* name : {"nx", "ny", "nz"}) text += fmt::format("property float {}\n", name);
  }
  text += fmt::format("element face {}\nproperty list uchar int {}\nend_header\n", faces.size(),
                      random.chance(0.5) ? "vertex_indices" : "vertex_index");
  const auto put_vector = [&](glm::dvec3 v) {
    for (int i = 0; i < 3; ++i) put(text, format, float(v[i]));
  };
  const auto end_line = [&] {
    if (format == PlyFormat::kText) text += "\n";
  };
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    put_vector(mesh.positions[i]);
    if (normals) put_vector(mesh.normals[i]);
    end_line();
  }
  for (const std::vector<int>& face : faces) {
    put(text, format, std::uint8_t(face.size()));
    for (const int k : face) put(text, format, std::int32_t(k));
    end_line();
  }
  return text;
}

}  // namespace penumbra::differential
