#include "scenes/mesh_tools.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "scenes/mikktspace.h"
#include "scenes/traceable.h"
#include "scenes/transform.h"

namespace penumbra {
namespace {

/// A triangle has no area if |(b - a) x (c - a)| over the square of its longest edge is at most this. It is
/// far below a sliver of aspect ratio 1e7, and above the rounding of collinear points.
constexpr double kFlatTriangle = 1e-14;
/// A vertex normal equals the face normal if the cosine between them differs from 1 by at most this.
constexpr double kSameNormal = 1e-9;
/// A normal from a file equals the face normal if the sine between them is at most this.
constexpr double kFileNormal = 1e-3;

bool is_flat(const Mesh& mesh, const glm::uvec3& t) {
  const glm::dvec3 &a = mesh.positions[t.x], &b = mesh.positions[t.y], &c = mesh.positions[t.z];
  const double longest = std::max({glm::distance(a, b), glm::distance(b, c), glm::distance(c, a)});
  if (!(longest > 0.0)) return true;
  // Divide before multiplying, so that tiny and huge scenes neither underflow nor overflow.
  return !(glm::length(glm::cross((b - a) / longest, (c - a) / longest)) > kFlatTriangle);
}

/// Whether its area is too small for single precision, or zero.
bool is_tiny(const Mesh& mesh, const glm::uvec3& t) { return !(triangle_cross(mesh, t) > kSmallestCross); }

std::size_t drop_flat_triangles(Mesh& mesh) {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    if (is_flat(mesh, mesh.triangles[i]) || is_tiny(mesh, mesh.triangles[i])) continue;
    if (!mesh.face_colours.empty()) mesh.face_colours[kept] = mesh.face_colours[i];
    if (!mesh.tangents.empty()) mesh.tangents[kept] = mesh.tangents[i];
    mesh.triangles[kept++] = mesh.triangles[i];
  }
  const std::size_t dropped = mesh.triangles.size() - kept;
  mesh.triangles.resize(kept);
  if (!mesh.face_colours.empty()) mesh.face_colours.resize(kept);
  if (!mesh.tangents.empty()) mesh.tangents.resize(kept);
  return dropped;
}

double angle(glm::dvec3 u, glm::dvec3 v) { return std::atan2(glm::length(glm::cross(u, v)), glm::dot(u, v)); }

/// For each vertex the sum of the adjacent faces' unit normals, weighted by angle; not normalised.
std::vector<glm::dvec3> summed_face_normals(const Mesh& mesh) {
  std::vector<glm::dvec3> sums(mesh.positions.size(), glm::dvec3(0.0));
  for (const glm::uvec3& t : mesh.triangles) {
    const glm::dvec3 p[3] = {mesh.positions[t.x], mesh.positions[t.y], mesh.positions[t.z]};
    const glm::dvec3 edges[3] = {glm::normalize(p[1] - p[0]), glm::normalize(p[2] - p[1]),
                                 glm::normalize(p[0] - p[2])};
    const glm::dvec3 n = glm::normalize(glm::cross(edges[0], edges[1]));
    for (int i = 0; i < 3; ++i) sums[t[i]] += angle(edges[i], -edges[(i + 2) % 3]) * n;
  }
  return sums;
}

void add_smooth_normals(Mesh& mesh) {
  const std::vector<glm::dvec3> sums = summed_face_normals(mesh);
  bool faceted = true;
  for (const glm::uvec3& t : mesh.triangles) {
    const glm::dvec3 n = glm::normalize(face_vector(mesh, t));
    for (int i = 0; i < 3; ++i) {
      faceted = faceted && glm::dot(sums[t[i]], n) >= (1.0 - kSameNormal) * glm::length(sums[t[i]]);
    }
  }
  if (faceted) return;
  mesh.normals.resize(sums.size());
  for (std::size_t i = 0; i < sums.size(); ++i) {
    // Where opposite faces meet there is no normal, so any will do. Vertices without a face are never seen.
    const double length = glm::length(sums[i]);
    mesh.normals[i] = length > 1e-12 ? glm::vec3(sums[i] / length) : glm::vec3(0.0f, 0.0f, 1.0f);
  }
}

std::size_t transform_normals(Mesh& mesh, const glm::dmat3& matrix) {
  std::vector<glm::dvec3> sums;
  std::size_t bad = 0;
  for (std::size_t i = 0; i < mesh.normals.size(); ++i) {
    glm::dvec3 n = matrix * glm::dvec3(mesh.normals[i]);
    if (!(glm::length(n) > 0.0) || !std::isfinite(glm::length(n))) {
      if (sums.empty()) sums = summed_face_normals(mesh);
      n = glm::length(sums[i]) > 1e-12 ? sums[i] : glm::dvec3(0.0, 0.0, 1.0);
      ++bad;
    }
    mesh.normals[i] = glm::vec3(glm::normalize(n));
  }
  return bad;
}

void wind_with_normals(Mesh& mesh) {
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    const glm::uvec3& t = mesh.triangles[i];
    const glm::dvec3 mean =
        glm::dvec3(mesh.normals[t.x]) + glm::dvec3(mesh.normals[t.y]) + glm::dvec3(mesh.normals[t.z]);
    if (glm::dot(face_vector(mesh, t), mean) < 0.0) turn_over(mesh, i);
  }
}

/// Adds quads (0, 1, 2, 3) of consecutive positions as triangles, wound so that their front is the
/// transformed front.
void add_quads(Mesh& mesh, const glm::dmat4& to_world) {
  const bool mirror = is_mirror(to_world);
  for (glm::dvec3& p : mesh.positions) p = transform_point(to_world, p);
  for (std::uint32_t i = 0; i < mesh.positions.size(); i += 4) {
    for (const glm::uvec3 t : {glm::uvec3(i, i + 1, i + 2), glm::uvec3(i, i + 2, i + 3)}) {
      mesh.triangles.push_back(mirror ? glm::uvec3(t.x, t.z, t.y) : t);
    }
  }
}

/// The texture coordinates, as in Mitsuba, of a corner of the cube's side along `axis`.
glm::vec2 cube_texcoord(int axis, double side, const glm::dvec3& p) {
  const bool far = side > 0.0;
  const glm::dvec2 uv = axis == 0   ? glm::dvec2(p.y, far ? -p.z : p.z)
                        : axis == 1 ? (far ? glm::dvec2(-p.x, -p.z) : glm::dvec2(p.z, p.x))
                                    : glm::dvec2(far ? p.y : -p.y, p.x);
  return 0.5 * (uv + 1.0);
}

constexpr glm::vec2 kQuadTexcoords[4] = {{0.0f, 0.0f}, {1.0f, 0.0f}, {1.0f, 1.0f}, {0.0f, 1.0f}};

}  // namespace

std::vector<std::string> describe(const MeshCleaning& cleaning) {
  std::vector<std::string> texts;
  const std::size_t flat = cleaning.flat_triangles, bad = cleaning.bad_normals;
  if (flat > 0)
    texts.push_back(fmt::format("left out {} {} without area", flat, flat == 1 ? "triangle" : "triangles"));
  if (bad > 0)
    texts.push_back(fmt::format("{} {} missing or of no length; computed from the faces", bad,
                                bad == 1 ? "normal is" : "normals are"));
  return texts;
}

void turn_over(Mesh& mesh, std::size_t triangle) {
  std::swap(mesh.triangles[triangle].y, mesh.triangles[triangle].z);
  if (!mesh.tangents.empty()) std::swap(mesh.tangents[triangle][1], mesh.tangents[triangle][2]);
}

void transform_tangents(Mesh& mesh, const glm::dmat4& to_world) {
  const float side = is_mirror(to_world) ? -1.0f : 1.0f;
  for (auto& corners : mesh.tangents)
    for (glm::vec4& t : corners) {
      t = glm::vec4(glm::vec3(transform_vector(to_world, glm::dvec3(t))), side * t.w);
    }
}

Expected<MeshCleaning> place_mesh(Mesh& mesh, const glm::dmat4& to_world, bool face_normals) {
  MeshCleaning cleaning;
  if (face_normals) mesh.normals.clear();
  const bool computes_tangents = mesh.computes_tangents && !mesh.texcoords.empty();
  mesh.computes_tangents = false;
  const bool makes_normals = mesh.normals.empty() && !face_normals;
  if (computes_tangents && !makes_normals) mesh.tangents = mikktspace_tangents(mesh);
  transform_tangents(mesh, to_world);
  for (glm::dvec3& p : mesh.positions) p = transform_point(to_world, p);
  if (auto near = check_vertices(mesh); !near) return std::unexpected(near.error());
  for (std::size_t i = 0; i < mesh.texcoords.size(); ++i) {
    if (!std::isfinite(mesh.texcoords[i].x) || !std::isfinite(mesh.texcoords[i].y)) {
      return fail(fmt::format("the texture coordinates of vertex {} are too large", i + 1));
    }
  }
  const auto has_area = [&](const glm::uvec3& t) { return !is_flat(mesh, t); };
  const bool is_something = std::ranges::any_of(mesh.triangles, has_area);
  cleaning.flat_triangles = drop_flat_triangles(mesh);
  if (is_something && mesh.triangles.empty())
    return fail("the mesh is too small for single precision: none of its triangles has twice an area above " +
                fmt::to_string(kSmallestCross));
  if (auto faces = check_faces(mesh); !faces) return std::unexpected(faces.error());
  if (!mesh.normals.empty()) {
    cleaning.bad_normals = transform_normals(mesh, normal_matrix(to_world));
    wind_with_normals(mesh);
  } else if (!face_normals) {
    add_smooth_normals(mesh);
  }
  if (computes_tangents && makes_normals) mesh.tangents = mikktspace_tangents(mesh);
  return cleaning;
}

std::uint32_t copy_vertex(const Mesh& from, std::uint32_t vertex, Mesh& to) {
  to.positions.push_back(from.positions[vertex]);
  if (!from.normals.empty()) to.normals.push_back(from.normals[vertex]);
  if (!from.texcoords.empty()) to.texcoords.push_back(from.texcoords[vertex]);
  if (!from.colours.empty()) to.colours.push_back(from.colours[vertex]);
  return std::uint32_t(to.positions.size() - 1);
}

Mesh part_of(const Mesh& mesh, std::span<const std::size_t> triangles) {
  Mesh part;
  part.computes_tangents = mesh.computes_tangents;
  std::map<std::uint32_t, std::uint32_t> copied;
  for (const std::size_t index : triangles) {
    glm::uvec3 t = mesh.triangles[index];
    for (int i = 0; i < 3; ++i) {
      const auto [known, is_new] = copied.try_emplace(t[i]);
      if (is_new) known->second = copy_vertex(mesh, t[i], part);
      t[i] = known->second;
    }
    part.triangles.push_back(t);
    if (!mesh.face_colours.empty()) part.face_colours.push_back(mesh.face_colours[index]);
    if (!mesh.tangents.empty()) part.tangents.push_back(mesh.tangents[index]);
  }
  return part;
}

glm::dvec3 face_vector(const Mesh& mesh, const glm::uvec3& t) {
  const glm::dvec3 &a = mesh.positions[t.x], &b = mesh.positions[t.y], &c = mesh.positions[t.z];
  return glm::cross(b - a, c - a);
}

void drop_face_normals(Mesh& mesh) {
  if (mesh.normals.empty()) return;
  for (const glm::uvec3& t : mesh.triangles) {
    const glm::dvec3 face = glm::normalize(face_vector(mesh, t));
    for (int i = 0; i < 3; ++i) {
      const glm::dvec3 n(mesh.normals[t[i]]);
      if (!(glm::dot(n, face) > 0.0) || !(glm::length(glm::cross(n, face)) <= kFileNormal)) return;
    }
  }
  mesh.normals.clear();
}

Mesh make_rectangle(const glm::dmat4& to_world) {
  Mesh mesh;
  mesh.positions = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
  mesh.texcoords.assign(std::begin(kQuadTexcoords), std::end(kQuadTexcoords));
  add_quads(mesh, to_world);
  return mesh;
}

Mesh make_elliptic_disk(const glm::dmat4& to_world) {
  constexpr int kSides = 512;  // the edge is within 4e-5 of a radius
  constexpr double kTurn = 2.0 * std::numbers::pi / kSides;
  // The polygon's radius such that its area is that of the unit disk.
  const double radius = std::sqrt(kTurn / std::sin(kTurn));
  const bool mirror = is_mirror(to_world);
  Mesh mesh;
  const auto corner = [&](double distance, double side) {
    const double angle = kTurn * side;
    mesh.positions.push_back(
        transform_point(to_world, distance * radius * glm::dvec3(std::cos(angle), std::sin(angle), 0.0)));
    mesh.texcoords.emplace_back(distance, side / kSides);
    return std::uint32_t(mesh.positions.size() - 1);
  };
  for (int i = 0; i < kSides; ++i) {
    // Each sector has its own centre vertex, whose texture coordinate is the middle of the sector.
    const std::uint32_t centre = corner(0.0, i + 0.5), first = corner(1.0, i), second = corner(1.0, i + 1);
    mesh.triangles.push_back(mirror ? glm::uvec3(centre, second, first) : glm::uvec3(centre, first, second));
  }
  return mesh;
}

Mesh make_cube(const glm::dmat4& to_world) {
  Mesh mesh;
  for (int axis = 0; axis < 3; ++axis) {
    for (const double side : {-1.0, 1.0}) {
      // (u, v, axis) is right-handed; the opposite side is wound the other way.
      const int u = (axis + 1) % 3, v = (axis + 2) % 3;
      for (const glm::vec2& corner : kQuadTexcoords) {
        glm::dvec3 p;
        p[axis] = side;
        p[u] = side * (2.0 * double(corner.x) - 1.0);
        p[v] = 2.0 * double(corner.y) - 1.0;
        mesh.positions.push_back(p);
        mesh.texcoords.push_back(cube_texcoord(axis, side, p));
      }
    }
  }
  add_quads(mesh, to_world);
  return mesh;
}

}  // namespace penumbra
