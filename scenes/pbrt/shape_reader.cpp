#include "scenes/pbrt/shape_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "scenes/mesh_reader.h"
#include "scenes/pbrt/type_rows.h"
#include "scenes/texture_needs.h"
#include "scenes/traceable.h"
#include "scenes/transform.h"

namespace penumbra::pbrt {
namespace {

constexpr std::size_t kMostTriangles = std::size_t{1} << 28, kMostShapes = 1000000;

double area_of(const Shape& shape) {
  if (const auto* sphere = std::get_if<Sphere>(&shape.geometry))
    return 4 * std::numbers::pi * sphere->radius * sphere->radius;
  if (const auto* disk = std::get_if<Disk>(&shape.geometry))
    return std::numbers::pi * disk->radius * disk->radius;
  const Mesh& mesh = std::get<Mesh>(shape.geometry);
  double area = 0;
  for (const glm::uvec3& t : mesh.triangles)
    area += 0.5 * glm::length(glm::cross(mesh.positions[t.y] - mesh.positions[t.x],
                                         mesh.positions[t.z] - mesh.positions[t.x]));
  return area;
}

/// Where the transform takes the first two axes, unit and at right angles.
std::pair<glm::dvec3, glm::dvec3> frame_axes(const glm::dmat4& m) {
  const glm::dvec3 x = glm::normalize(glm::dvec3(m[0])), y(m[1]);
  return {x, glm::normalize(y - glm::dot(x, y) * x)};
}

/// Nothing, and an error, where it is none.
std::optional<double> read_radius(Parameters& parameters, SourceLocation location, ReaderReport& report) {
  const double radius = parameters.number("radius", 1.0, report);
  if (radius > 0.0) return radius;
  report.error(parameters.location("radius", location),
               fmt::format("a radius must be above 0, not {}", radius));
  return std::nullopt;
}

}  // namespace

/// P, N and uv; none, and an error, without P.
std::optional<Mesh> ShapeReader::vertices(Parameters& parameters, SourceLocation location) {
  ReaderReport& report = context_.report;
  const std::vector<double> p = parameters.numbers("P", {"point3", "point"}, 3, report);
  const std::vector<double> n = parameters.numbers("N", {"normal3", "normal"}, 3, report);
  const std::vector<double> uv = parameters.numbers("uv", {"point2", "vector2", "float"}, 2, report);
  if (p.empty()) {
    report.error(location, "a mesh needs \"point3 P\"");
    return std::nullopt;
  }
  Mesh mesh;
  for (std::size_t i = 0; i + 2 < p.size(); i += 3) mesh.positions.emplace_back(p[i], p[i + 1], p[i + 2]);
  for (std::size_t i = 0; i + 2 < n.size(); i += 3) mesh.normals.emplace_back(n[i], n[i + 1], n[i + 2]);
  for (std::size_t i = 0; i + 1 < uv.size(); i += 2) mesh.texcoords.emplace_back(uv[i], uv[i + 1]);
  const std::size_t count = mesh.positions.size();
  if ((!mesh.normals.empty() && mesh.normals.size() != count) ||
      (!mesh.texcoords.empty() && mesh.texcoords.size() != count)) {
    report.error(location, fmt::format("a mesh of {} points, {} normals and {} texture coordinates", count,
                                       mesh.normals.size(), mesh.texcoords.size()));
    return std::nullopt;
  }
  return mesh;
}

std::vector<std::uint32_t> ShapeReader::indices(Parameters& parameters, const Mesh& mesh, std::size_t corners,
                                                SourceLocation location) {
  const std::vector<double> given = parameters.numbers("indices", {"integer"}, corners, context_.report);
  std::vector<std::uint32_t> result;
  for (const double index : given) {
    if (!(index >= 0 && index < double(mesh.positions.size()) && index == std::floor(index))) {
      context_.report.error(
          parameters.location("indices", location),
          fmt::format("an index {}, where there are {} points", index, mesh.positions.size()));
      return {};
    }
    result.push_back(std::uint32_t(index));
  }
  // A single face may do without.
  if (given.empty() && mesh.positions.size() == corners)
    for (std::uint32_t i = 0; i < corners; ++i) result.push_back(i);
  if (result.empty() && !parameters.has("indices"))
    context_.report.error(
        location, fmt::format("a mesh of {} points needs \"integer indices\"", mesh.positions.size()));
  return result;
}

std::optional<ShapeReader::Geometry> ShapeReader::triangle_mesh(Parameters& parameters,
                                                                SourceLocation location) {
  auto mesh = vertices(parameters, location);
  if (!mesh) return std::nullopt;
  parameters.accept({"S", "faceIndices"});
  const auto corners = indices(parameters, *mesh, 3, location);
  for (std::size_t i = 0; i + 2 < corners.size(); i += 3)
    mesh->triangles.emplace_back(corners[i], corners[i + 1], corners[i + 2]);
  return std::move(*mesh);
}

/// Patches (0, 0), (1, 0), (0, 1), (1, 1), each as two triangles.
std::optional<ShapeReader::Geometry> ShapeReader::bilinear_mesh(Parameters& parameters,
                                                                SourceLocation location) {
  auto mesh = vertices(parameters, location);
  if (!mesh) return std::nullopt;
  parameters.accept({"faceIndices"});
  const auto corners = indices(parameters, *mesh, 4, location);
  bool warped = false;
  for (std::size_t i = 0; i + 3 < corners.size(); i += 4) {
    const auto* c = &corners[i];
    mesh->triangles.emplace_back(c[0], c[1], c[3]);
    mesh->triangles.emplace_back(c[0], c[3], c[2]);
    const auto& p = mesh->positions;
    const glm::dvec3 a = p[c[1]] - p[c[0]], b = p[c[2]] - p[c[0]], d = p[c[3]] - p[c[0]];
    const double volume = std::abs(glm::dot(glm::cross(a, b), d));
    warped = warped || volume > 1e-6 * glm::length(a) * glm::length(b) * glm::length(d);
  }
  if (warped)
    context_.report.warn_counted(location, "patches of bilinear meshes that are not flat are two triangles");
  return std::move(*mesh);
}

std::optional<ShapeReader::Geometry> ShapeReader::ply_mesh(Parameters& parameters, SourceLocation location) {
  ReaderReport& report = context_.report;
  const std::string name = parameters.text("filename", "", report);
  const SourceLocation place = parameters.location("filename", location);
  if (parameters.has("displacement")) {
    parameters.take("displacement");
    report.unsupported(place, "displacement of meshes is not read", "the mesh is as it is");
  }
  parameters.accept({"edgelength"});
  const std::array<std::filesystem::path, 1> folders = {context_.folder};
  const auto path = context_.files.find(name, folders);
  const auto file = path ? context_.files.read(*path, kMaxMeshFileBytes) : std::unexpected(path.error());
  if (!file) {
    report.error(place, file.error().message);
    return std::nullopt;
  }
  auto read = read_ply(**file);
  if (!read) {
    report.error(place, read.error().message);
    return std::nullopt;
  }
  for (const std::string& text : describe(read->faces)) report.warn(place, fmt::format("'{}': {}", name, text));
  return std::move(read->mesh);
}

std::optional<ShapeReader::Geometry> ShapeReader::sphere(Parameters& parameters, SourceLocation location) {
  ReaderReport& report = context_.report;
  const auto radius = read_radius(parameters, location, report);
  if (!radius) return std::nullopt;
  if (parameters.number("zmin", -*radius, report) > -*radius ||
      parameters.number("zmax", *radius, report) < *radius ||
      parameters.number("phimax", 360.0, report) < 360.0)
    report.unsupported(location, "parts of spheres are not read", "it is a whole one");
  Sphere sphere;
  sphere.radius = *radius;
  return sphere;
}

std::optional<ShapeReader::Geometry> ShapeReader::disk(Parameters& parameters, SourceLocation location) {
  ReaderReport& report = context_.report;
  const auto radius = read_radius(parameters, location, report);
  if (!radius) return std::nullopt;
  if (parameters.number("innerradius", 0.0, report) > 0.0 ||
      parameters.number("phimax", 360.0, report) < 360.0)
    report.unsupported(location, "rings and parts of disks are not read", "it is a whole disk");
  Disk disk;
  disk.radius = *radius;
  disk.center = {0.0, 0.0, parameters.number("height", 0.0, report)};
  return disk;
}

std::optional<ReadShape> ShapeReader::read(const std::string& type, Parameters& parameters,
                                           const GraphicsState& state, SourceLocation location) {
  ReaderReport& report = context_.report;
  struct Reader {
    const char* type;
    std::optional<Geometry> (ShapeReader::*read)(Parameters&, SourceLocation);
  };
  static constexpr Reader kReaders[] = {{"trianglemesh", &ShapeReader::triangle_mesh},
                                        {"bilinearmesh", &ShapeReader::bilinear_mesh},
                                        {"plymesh", &ShapeReader::ply_mesh},
                                        {"sphere", &ShapeReader::sphere},
                                        {"disk", &ShapeReader::disk}};
  const auto* found = find_row(kReaders, type, "shape", "it is left out", location, report);
  if (found == nullptr) return std::nullopt;
  ReadShape shape;
  shape.alpha = textures_.number(parameters, "alpha", 1.0, 0.0, 1e30);
  auto geometry = (this->*found->read)(parameters, location);
  parameters.finish(fmt::format("the shape '{}'", type), report);
  if (!geometry) return std::nullopt;
  shape.geometry = std::move(*geometry);
  shape.name = fmt::format("{} at {}", type, describe(location));
  shape.ctm = state.ctm;
  shape.reverse_orientation = state.reverse_orientation;
  shape.material = state.material;
  shape.material_name = state.material_name;
  shape.area_light = state.area_light;
  shape.location = location;
  return shape;
}

std::pair<int, int> ShapeReader::materials_of(const ReadShape& shape) {
  SurfaceMaterial material = *shape.material;
  if (shape.alpha.texture != kNoTexture || shape.alpha.value < 1.0f) {
    // Once for all shapes that share both.
    const auto [known, is_new] =
        masked_.try_emplace({shape.material, shape.alpha.value, shape.alpha.texture});
    if (is_new) {
      MaskBsdf mask;
      mask.opacity = shape.alpha;
      known->second = masked("alpha", mask, material);
    }
    material = known->second;
  }
  // Alone, nothing is the mask of nothing.
  for (MaterialTree* side : {&material.front, &material.back})
    if (is_nothing(*side)) {
      const auto [known, is_new] = masked_.try_emplace({nullptr, 0.0f, kNoTexture});
      if (is_new) {
        const MaterialTree nothing = branch("interface", MaskBsdf{0.0f}, {}, {});
        known->second = {nothing, nothing};
      }
      *side = known->second.front;
    }
  return installer_.add(material, context_.scene);
}

void ShapeReader::place(const ReadShape& read, const glm::dmat4& instance) {
  ReaderReport& report = context_.report;
  SceneDescription& scene = context_.scene;
  const glm::dmat4 to_world = instance * read.ctm;
  if (is_singular(to_world)) return report.error(read.location, "the transform of this shape flattens it");
  if (scene.shapes.size() >= kMostShapes || triangles_ > kMostTriangles)
    return report.error(read.location,
                        fmt::format("more than {} shapes or {} triangles", kMostShapes, kMostTriangles));
  Shape shape;
  shape.name = read.name;
  shape.material = read.material_name;
  // The front is where the normal of the shape's own space points to, whatever the transform mirrors.
  shape.flip_normals = read.reverse_orientation;
  const auto [x_axis, y_axis] = frame_axes(to_world);
  if (const auto* mesh = std::get_if<Mesh>(&read.geometry)) {
    Mesh copy = *mesh;
    const bool faceted = copy.normals.empty();
    if (faceted && is_mirror(to_world))
      for (glm::uvec3& t : copy.triangles) std::swap(t.y, t.z);
    if (!report.place(copy, to_world, faceted, read.name, read.location)) return;
    triangles_ += copy.triangles.size();
    shape.geometry = std::move(copy);
  } else if (const auto* sphere = std::get_if<Sphere>(&read.geometry)) {
    const auto scale = uniform_scale(to_world);
    if (!scale)
      return report.unsupported(read.location, "spheres that are scaled by different factors are not read",
                                "it is left out");
    Sphere placed{transform_point(to_world, glm::dvec3(0.0)), sphere->radius * *scale, x_axis, y_axis,
                  (is_mirror(to_world) ? -1.0 : 1.0) * glm::cross(x_axis, y_axis)};
    if (const auto traceable = check_traceable(placed); !traceable)
      return report.error(read.location, traceable.error().message);
    shape.geometry = placed;
  } else if (const auto* disk = std::get_if<Disk>(&read.geometry)) {
    const auto scale = uniform_scale(to_world, 2);
    if (!scale)
      return report.unsupported(read.location, "disks that are scaled by different factors are not read",
                                "it is left out");
    const Disk placed{transform_point(to_world, disk->center),
                      glm::normalize(normal_matrix(to_world) * glm::dvec3(0.0, 0.0, 1.0)),
                      disk->radius * *scale, x_axis, y_axis};
    if (const auto traceable = check_traceable(placed); !traceable)
      return report.error(read.location, traceable.error().message);
    shape.geometry = placed;
  }
  std::tie(shape.front_bsdf, shape.back_bsdf) = materials_of(read);
  if (read.area_light != nullptr) {
    const AreaLight& light = *read.area_light;
    shape.two_sided_emission = light.two_sided;
    double scale = 1.0;
    if (light.power)
      scale = *light.power / (std::numbers::pi * area_of(shape) * (light.two_sided ? 2.0 : 1.0));
    shape.radiance = glm::vec3(glm::dvec3(light.radiance) * scale);
    if (!(std::max({shape.radiance->x, shape.radiance->y, shape.radiance->z}) < 1e37f))
      return report.error(light.location, "the radiance of this light is not finite");
    if (shape.two_sided_emission && std::holds_alternative<Sphere>(shape.geometry)) {
      report.warn_counted(light.location, "spheres shine outwards alone");
      shape.two_sided_emission = false;
    }
  }
  if (missing_for_textures(scene, shape).coordinates)
    report.warn(read.location,
                fmt::format("'{}' has textures, but no texture coordinates; those of each triangle are "
                            "its barycentric ones",
                            read.name));
  if (!std::holds_alternative<Mesh>(shape.geometry) && texture_needs(scene, shape).coordinates)
    report.warn_counted(read.location,
                     "textures on spheres and disks are as Mitsuba turns them, not as pbrt does");
  scene.shapes.push_back(std::move(shape));
}

}  // namespace penumbra::pbrt
