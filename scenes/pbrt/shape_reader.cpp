#include "scenes/pbrt/shape_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "scenes/curve_mesh.h"
#include "scenes/instances.h"
#include "scenes/mesh_reader.h"
#include "scenes/pbrt/loop_subdivision.h"
#include "scenes/pbrt/mesh_faces.h"
#include "scenes/pbrt/quadric_mesh.h"
#include "scenes/pbrt/state.h"
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
  if (const auto* cylinder = std::get_if<Cylinder>(&shape.geometry))
    return 2 * std::numbers::pi * cylinder->radius * cylinder->length;
  const Mesh& mesh = std::get<Mesh>(shape.geometry);
  double area = 0;
  for (const glm::uvec3& t : mesh.triangles)
    area += 0.5 * glm::length(glm::cross(mesh.positions[t.y] - mesh.positions[t.x],
                                         mesh.positions[t.z] - mesh.positions[t.x]));
  return area;
}

/// Whether the transform changes its kind of shape.
bool is_stretched(const Geometry& geometry, const glm::dmat4& to_world) {
  if (std::holds_alternative<Sphere>(geometry)) return !uniform_scale(to_world);
  if (std::holds_alternative<Disk>(geometry)) return !uniform_scale(to_world, 2);
  const auto* cylinder = std::get_if<Cylinder>(&geometry);
  return cylinder != nullptr && !placed_cylinder(*cylinder, to_world);
}

/// The mesh of a quadric in its own space.
Mesh mesh_of(const Geometry& geometry) {
  if (const auto* sphere = std::get_if<Sphere>(&geometry))
    return sphere_mesh(sphere->radius, -sphere->radius, sphere->radius);
  if (const auto* disk = std::get_if<Disk>(&geometry)) return disk_mesh(disk->radius, 0.0, disk->center.z);
  const auto& cylinder = std::get<Cylinder>(geometry);
  return cylinder_mesh(cylinder.radius, cylinder.center.z, cylinder.center.z + cylinder.length);
}

/// The transformed first two axes, made orthonormal.
std::pair<glm::dvec3, glm::dvec3> frame_axes(const glm::dmat4& m) {
  const glm::dvec3 x = glm::normalize(glm::dvec3(m[0])), y(m[1]);
  return {x, glm::normalize(y - glm::dot(x, y) * x)};
}

/// Nothing, and an error, if it is not valid.
std::optional<double> read_radius(Parameters& parameters, SourceLocation location, ReaderReport& report) {
  const double radius = parameters.number("radius", 1.0, report);
  if (radius > 0.0) return radius;
  report.error(parameters.location("radius", location),
               fmt::format("a radius must be above 0, not {}", radius));
  return std::nullopt;
}

}  // namespace

/// Reads P, N and uv. Nothing, and an error, without P.
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
  // A single face needs no indices.
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

/// Patches with corners (0, 0), (1, 0), (0, 1), (1, 1), each as two triangles.
std::optional<ShapeReader::Geometry> ShapeReader::bilinear_mesh(Parameters& parameters,
                                                                SourceLocation location) {
  auto mesh = vertices(parameters, location);
  if (!mesh) return std::nullopt;
  parameters.accept({"faceIndices", "emissionfilename"});  // the latter chooses samples alone
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
  for (const auto& texts : {read->warnings, describe(read->faces)})
    for (const std::string& text : texts) report.warn(place, fmt::format("'{}': {}", name, text));
  return std::move(read->mesh);
}

/// An angle about the z axis in degrees. Nothing, and an error, if it is not valid.
std::optional<double> ShapeReader::turn(Parameters& parameters, SourceLocation location) {
  const double degrees = parameters.number("phimax", kWholeTurn, context_.report);
  if (degrees > 0.0) return std::min(degrees, kWholeTurn);
  context_.report.error(parameters.location("phimax", location),
                        fmt::format("phimax must be above 0, not {}", degrees));
  return std::nullopt;
}

std::optional<ShapeReader::Geometry> ShapeReader::sphere(Parameters& parameters, SourceLocation location) {
  ReaderReport& report = context_.report;
  const auto radius = read_radius(parameters, location, report);
  const auto degrees = turn(parameters, location);
  if (!radius || !degrees) return std::nullopt;
  const double a = parameters.number("zmin", -*radius, report),
               b = parameters.number("zmax", *radius, report);
  const double low = std::clamp(std::min(a, b), -*radius, *radius),
               high = std::clamp(std::max(a, b), -*radius, *radius);
  if (low > -*radius || high < *radius || *degrees < kWholeTurn) {
    if (low < high) return sphere_mesh(*radius, low, high, *degrees);
    report.error(location, "zmin and zmax leave nothing of this sphere");
    return std::nullopt;
  }
  Sphere sphere;
  sphere.radius = *radius;
  return sphere;
}

std::optional<ShapeReader::Geometry> ShapeReader::disk(Parameters& parameters, SourceLocation location) {
  ReaderReport& report = context_.report;
  const auto radius = read_radius(parameters, location, report);
  const auto degrees = turn(parameters, location);
  if (!radius || !degrees) return std::nullopt;
  const double inner = parameters.number("innerradius", 0.0, report),
               height = parameters.number("height", 0.0, report);
  if (!(inner >= 0.0 && inner < *radius)) {
    report.error(parameters.location("innerradius", location),
                 fmt::format("an innerradius must be at least 0 and below the radius, not {}", inner));
    return std::nullopt;
  }
  if (inner > 0.0 || *degrees < kWholeTurn) return disk_mesh(*radius, inner, height, *degrees);
  Disk disk;
  disk.radius = *radius;
  disk.center = {0.0, 0.0, height};
  return disk;
}

std::optional<ShapeReader::Geometry> ShapeReader::cylinder(Parameters& parameters, SourceLocation location) {
  ReaderReport& report = context_.report;
  const auto radius = read_radius(parameters, location, report);
  const auto degrees = turn(parameters, location);
  if (!radius || !degrees) return std::nullopt;
  const double a = parameters.number("zmin", -1.0, report), b = parameters.number("zmax", 1.0, report);
  const double low = std::min(a, b), high = std::max(a, b);
  if (!(low < high)) {
    report.error(location, fmt::format("the ends of a cylinder, zmin and zmax, are both at {}", a));
    return std::nullopt;
  }
  if (*degrees < kWholeTurn) return cylinder_mesh(*radius, low, high, *degrees);
  Cylinder cylinder;
  cylinder.center = {0.0, 0.0, low};
  cylinder.radius = *radius;
  cylinder.length = high - low;
  return cylinder;
}

std::optional<ShapeReader::Geometry> ShapeReader::subdivision(Parameters& parameters,
                                                              SourceLocation location) {
  auto mesh = vertices(parameters, location);
  if (!mesh) return std::nullopt;
  parameters.accept({"scheme"});
  const auto corners = indices(parameters, *mesh, 3, location);
  for (std::size_t i = 0; i + 2 < corners.size(); i += 3)
    mesh->triangles.emplace_back(corners[i], corners[i + 1], corners[i + 2]);
  const std::int64_t levels = parameters.integer("levels", 3, context_.report);
  if (levels < 0 || levels > 12) {
    context_.report.error(parameters.location("levels", location), "levels must be 0 to 12");
    return std::nullopt;
  }
  auto fine = loop_subdivided(*mesh, int(levels));
  if (fine) return std::move(*fine);
  context_.report.error(location, fine.error().message);
  return std::nullopt;
}

std::optional<Curves> ShapeReader::curves(Parameters& parameters, SourceLocation location) {
  ReaderReport& report = context_.report;
  const std::vector<double> p = parameters.numbers("P", {"point3", "point"}, 3, report);
  const std::string basis = parameters.text("basis", "bezier", report),
                    type = parameters.text("type", "flat", report);
  const std::int64_t degree = parameters.integer("degree", 3, report);
  const double width = parameters.number("width", 1.0, report),
               first = parameters.number("width0", width, report),
               last = parameters.number("width1", width, report);
  parameters.accept({"N", "splitdepth"});
  const auto wrong = [&](const char* name, std::string_view message) {
    report.error(parameters.location(name, location), message);
    return std::nullopt;
  };
  if (degree != 2 && degree != 3) return wrong("degree", "a curve has degree 2 or 3");
  if (basis != "bezier" && basis != "bspline") return wrong("basis", "a basis is bezier or bspline");
  if (type != "flat" && type != "cylinder" && type != "ribbon")
    return wrong("type", "a curve is flat, cylinder or ribbon");
  if (!(first >= 0.0 && last >= 0.0 && std::max(first, last) < 1e30 && std::max(first, last) > 0.0))
    return wrong("width", "the widths of a curve are at least 0, one is above 0");
  std::vector<glm::dvec3> points;
  for (std::size_t i = 0; i + 2 < p.size(); i += 3) points.emplace_back(p[i], p[i + 1], p[i + 2]);
  const auto n = std::size_t(degree);
  const bool bezier = basis == "bezier";
  if (points.size() <= n || (bezier && (points.size() - 1) % n != 0))
    return wrong(
        "P", fmt::format(
                 "a curve of {} points; a {} of degree {} has {}", points.size(), basis, degree,
                 bezier ? fmt::format("1 more than a multiple of {}", n) : fmt::format("{} or more", n + 1)));
  if (type == "ribbon") report.warn_counted(location, "ribbon curves are round ones, as wide as they are");
  Curves curves{type == "flat"       ? CurveForm::kFlat
                : type == "cylinder" ? CurveForm::kCylinder
                                     : CurveForm::kRound,
                bspline_curves(points, {bezier, int(degree), 0.5 * first, 0.5 * last})};
  const auto count = double(curves.curves.size());
  for (std::size_t i = 0; i < curves.curves.size(); ++i)
    curves.ranges.emplace_back(double(i) / count, double(i + 1) / count);
  return curves;
}

void ShapeReader::read(const std::string& type, Parameters& parameters, const GraphicsState& state,
                       SourceLocation location) {
  ReaderReport& report = context_.report;
  struct Reader {
    const char* type;
    std::optional<Geometry> (ShapeReader::*read)(Parameters&, SourceLocation);
    Faces faces = Faces::kWhole;
  };
  static constexpr Reader kReaders[] = {{"trianglemesh", &ShapeReader::triangle_mesh, Faces::kTriangles},
                                        {"bilinearmesh", &ShapeReader::bilinear_mesh, Faces::kPatches},
                                        {"plymesh", &ShapeReader::ply_mesh, Faces::kTriangles},
                                        {"loopsubdiv", &ShapeReader::subdivision, Faces::kTriangles},
                                        {"sphere", &ShapeReader::sphere},
                                        {"cylinder", &ShapeReader::cylinder},
                                        {"disk", &ShapeReader::disk}};
  const bool is_curve = type == "curve";
  const auto* found =
      is_curve ? nullptr : find_row(kReaders, type, "shape", "it is left out", location, report, {"curve"});
  if (found == nullptr && !is_curve) return;
  Use use;
  use.material = state.material;
  use.media = state.media;
  use.location = location;
  if (const Parameter* alpha = parameters.take("alpha")) use.alpha = Parameters::of(*alpha);
  if (is_curve) {
    auto given = curves(parameters, location);
    parameters.finish("the shape 'curve'", report);
    if (!given) return;
    // Consecutive similar curves become one mesh, because there may be millions.
    const bool alike = !pending_.curves.curves.empty() && !use.alpha && !pending_.use.alpha &&
                       pending_.curves.form == given->form && pending_.state.has_same_surface(state);
    if (!alike) finish_curves();
    if (!alike) pending_ = {{given->form, {}}, std::move(use), state};
    std::ranges::move(given->curves, std::back_inserter(pending_.curves.curves));
    std::ranges::move(given->ranges, std::back_inserter(pending_.curves.ranges));
    return;
  }
  finish_curves();
  use.faces = found->faces;
  auto geometry = (this->*found->read)(parameters, location);
  parameters.finish(fmt::format("the shape '{}'", type), report);
  if (!geometry) return;
  add(type, std::move(*geometry), std::move(use), state);
}

void ShapeReader::finish_curves() {
  if (pending_.curves.curves.empty()) return;
  PendingCurves curves = std::exchange(pending_, {});
  const bool moves = curves.state.ctm.start != curves.state.ctm.end;
  // Ribbons with directions of their own are tubes.
  curves.use.is_tube = moves || curves.curves.form == CurveForm::kRound ||
                       curves.state.area_light != nullptr || curves.use.media.are_different();
  if (!curves.use.is_tube) return add("curve", std::move(curves.curves), std::move(curves.use), curves.state);
  auto mesh = curve_mesh(curves.curves);
  if (!mesh) return context_.report.error(curves.use.location, mesh.error().message);
  add("curve", std::move(mesh->mesh), std::move(curves.use), curves.state);
}

void ShapeReader::add(const std::string& type, Geometry geometry, Use use, const GraphicsState& state) {
  const SourceLocation location = use.location;
  Shape shape;
  shape.name = fmt::format("{} at {}", type, describe(location));
  shape.material = state.material_name;
  // The front follows the normal in the shape's own space, even if the transform mirrors.
  shape.flip_normals = state.reverse_orientation;
  shape.geometry = std::move(geometry);
  // Of shapes of our own, spheres and cylinders shine outwards alone.
  if (state.area_light != nullptr && state.area_light->two_sided && use.faces == Faces::kWhole &&
      !std::holds_alternative<Mesh>(shape.geometry))
    shape.geometry = mesh_of(shape.geometry);
  const auto* mesh = std::get_if<Mesh>(&shape.geometry);
  const bool has_faces =
      mesh != nullptr && use.faces != Faces::kWhole &&
      (mesh->texcoords.empty() || (state.area_light != nullptr && state.area_light->power));
  const std::vector<glm::uvec3> before = has_faces ? mesh->triangles : std::vector<glm::uvec3>();
  const auto placement = context_.motion.place(state.ctm, location, context_.report);
  if (!placement || !place(shape, *placement, state.ctm, type == "loopsubdiv", location)) return;
  use.placement = *placement;
  if (has_faces) use.origins = origins_of(before, mesh->triangles);
  if (state.area_light != nullptr)
    add_lights(std::move(shape), use, *state.area_light);
  else
    add_part(std::move(shape), std::move(use));
}

void ShapeReader::add_part(Shape shape, Use use) {
  const auto* mesh = std::get_if<Mesh>(&shape.geometry);
  if (mesh == nullptr || !mesh->texcoords.empty()) use.origins = {};
  shapes().push_back(std::move(shape));
  uses().push_back(std::move(use));
}

/// Adds an emitting shape. Where pbrt's faces are lights of the same power, those of different areas become
/// different shapes, because their radiances differ.
void ShapeReader::add_lights(Shape shape, const Use& use, const AreaLight& light) {
  const auto* mesh = std::get_if<Mesh>(&shape.geometry);
  if (!light.power || use.faces == Faces::kWhole || mesh == nullptr) {
    const double area = area_of(shape);
    make_emit(shape, light, area);
    return add_part(std::move(shape), use);
  }
  std::vector<FacesOfArea> parts =
      split_by_face_area(*mesh, use.origins, use.faces == Faces::kPatches ? 2 : 1);
  for (FacesOfArea& part : parts) {
    Shape of_area = shape;
    of_area.geometry = std::move(part.mesh);
    make_emit(of_area, light, part.face_area);
    Use of_part = use;
    of_part.origins = std::move(part.origins);
    add_part(std::move(of_area), std::move(of_part));
  }
}

std::vector<Shape>& ShapeReader::shapes() {
  return object_ >= 0 ? context_.scene.groups[std::size_t(object_)].shapes : context_.scene.shapes;
}

void ShapeReader::begin_object(const std::string& name, SourceLocation location) {
  finish_curves();
  const int group = int(context_.scene.groups.size());
  if (!objects_.try_emplace(name, group).second)
    context_.report.error(location, fmt::format("the object '{}' is there twice", name));
  context_.scene.groups.push_back({name, {}, {}});
  group_uses_.emplace_back();
  object_ = group;
}

void ShapeReader::end_object() {
  finish_curves();
  object_ = -1;
}

void ShapeReader::place_object(const std::string& name, const TransformPair& to_world,
                               SourceLocation location) {
  ReaderReport& report = context_.report;
  const auto found = objects_.find(name);
  if (found == objects_.end()) {
    std::vector<std::string> known;
    for (const auto& [each, ignored] : objects_) known.push_back(each);
    return report.error(location, fmt::format("there is no object '{}' before this{}", name,
                                              known_names(name, known, "There are")));
  }
  std::vector<ShapeInstance>& instances = context_.scene.instances;
  if (instances.size() >= kMaxInstances)
    return report.error(location, fmt::format("more than {} instances", kMaxInstances));
  if (is_singular(to_world.start) || is_singular(to_world.end))
    return report.error(location, fmt::format("the transform of this instance of '{}' flattens it", name));
  const auto placement = context_.motion.place(to_world, location, report);
  if (!placement) return;
  if (placement->node >= 0)
    context_.motion.motion.instances.push_back({instances.size(), {placement->node, glm::dmat4(1.0)}});
  instances.push_back({fmt::format("{} at {}", name, describe(location)), found->second, placement->shown});
}

void ShapeReader::finish() {
  finish_curves();
  SceneDescription& scene = context_.scene;
  const auto finish_all = [&](int group, std::vector<Shape>& shapes, std::vector<Use>& uses) {
    for (std::size_t i = 0; i < uses.size(); ++i) {
      finish(shapes[i], uses[i]);
      if (uses[i].placement.node >= 0) move(group, i, shapes[i], uses[i]);
    }
  };
  finish_all(-1, scene.shapes, uses_);
  for (std::size_t g = 0; g < group_uses_.size(); ++g)
    finish_all(int(g), scene.groups[g].shapes, group_uses_[g]);
}

void ShapeReader::move(int group, std::size_t index, const Shape& shape, const Use& use) {
  // A mesh that was made smooth has its normals.
  context_.motion.motion.shapes.push_back(
      {.group = group, .shape = index, .rest = shape.geometry, .place = use.placement.place()});
  if (shape.radiance)
    context_.report.warn_counted(use.location,
                                 "area lights on shapes that move, move with them; pbrt refuses them");
}

TexturedNumber ShapeReader::alpha_of(const Use& use) {
  if (!use.alpha) return TexturedNumber(1.0f);
  Parameters parameters = *use.alpha;
  return textures_.number(parameters, "alpha", 1.0, 0.0, 1e30);
}

std::shared_ptr<const SurfaceMaterial> ShapeReader::material_of(const Use& use) {
  const std::shared_ptr<const SurfaceMaterial> own = materials_.material(use.material);
  if (!use.is_tube) return own;
  std::shared_ptr<const SurfaceMaterial>& of_tube = of_tubes_[own];
  if (of_tube == nullptr) of_tube = std::make_shared<const SurfaceMaterial>(hair_of_tubes(*own));
  return of_tube;
}

std::pair<int, int> ShapeReader::materials_of(const Use& use, const TexturedNumber& alpha) {
  const std::shared_ptr<const SurfaceMaterial> own = material_of(use);
  SurfaceMaterial material = *own;
  if (alpha.texture != kNoTexture || alpha.value < 1.0f) {
    // Created once for all shapes with the same material and alpha.
    const auto [known, is_new] = masked_.try_emplace({own, alpha.value, alpha.texture});
    if (is_new) {
      MaskBsdf mask;
      mask.opacity = alpha;
      known->second = masked("alpha", mask, material);
    }
    material = known->second;
  }
  // A mask of no surface is no surface.
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

void ShapeReader::finish(Shape& shape, Use& use) {
  ReaderReport& report = context_.report;
  if (report.full()) return;
  const TexturedNumber alpha = alpha_of(use);
  if (shape.radiance) cut_emission(shape, use, alpha);
  std::tie(shape.front_bsdf, shape.back_bsdf) = materials_of(use, alpha);
  if (use.media.are_different()) {
    shape.interior = media_.install(use.media.inside, use.media.location);
    shape.exterior = media_.install(use.media.outside, use.media.location);
  }
  map_textures(shape, use);
  set_coordinates(shape, use);
}

/// Where alpha cuts a shape away, it does not shine either. The exception is pbrt's: a shape with alpha 0
/// everywhere shines as if it were there, on all but rays, which do not meet it.
void ShapeReader::cut_emission(Shape& shape, const Use& use, const TexturedNumber& alpha) {
  const SurfaceMaterial& material = *materials_.material(use.material);
  if (is_nothing(material.front) && is_nothing(material.back)) {
    context_.report.warn(use.location, "an area light on the material 'interface' is ignored, as in pbrt");
    shape.radiance.reset();
    shape.radiance_texture = kNoTexture;
    return;
  }
  if (alpha.texture == kNoTexture) {
    if (alpha.value == 0.0f)
      shape.unseen_emission = true;
    else
      *shape.radiance *= std::min(alpha.value, 1.0f);
    return;
  }
  const auto cut = textures_.product(shape.radiance_texture, alpha.texture);
  if (cut)
    shape.radiance_texture = *cut;
  else
    context_.report.unsupported(
        use.location,
        "the image of a light is cut by an alpha that is no image, or mapped otherwise; "
        "that is not read",
        "it is not cut");
}

/// Gives meshes that textures need pbrt's own texture coordinates, and disks those of pbrt.
void ShapeReader::set_coordinates(Shape& shape, const Use& use) {
  if (!texture_needs(context_.scene, shape).coordinates) return;
  if (const auto* disk = std::get_if<Disk>(&shape.geometry)) {
    const glm::dmat4 to_world(glm::dvec4(disk->x_axis, 0.0), glm::dvec4(disk->y_axis, 0.0),
                              glm::dvec4(disk->normal, 0.0), glm::dvec4(disk->center, 1.0));
    Mesh mesh = disk_mesh(disk->radius, 0.0, 0.0);
    if (context_.report.place(mesh, to_world, false, shape.name, use.location))
      shape.geometry = std::move(mesh);
    return;
  }
  auto* mesh = std::get_if<Mesh>(&shape.geometry);
  if (mesh != nullptr && mesh->texcoords.empty() && use.faces != Faces::kWhole)
    set_default_coordinates(*mesh, use.origins, use.faces == Faces::kPatches);
}

/// Computes texture coordinates from vertex positions if the shape's textures use a mapping.
void ShapeReader::map_textures(Shape& shape, const Use& use) {
  ReaderReport& report = context_.report;
  const std::vector<int> textures = texture_needs(context_.scene, shape).mapped;
  const TextureMapping* mapping = nullptr;
  for (const int each : textures)
    if (const TextureMapping* own = textures_.mapping_of(each); own != nullptr && mapping == nullptr)
      mapping = own;
  if (mapping == nullptr) return;
  auto* mesh = std::get_if<Mesh>(&shape.geometry);
  if (mesh == nullptr)
    return report.unsupported(
        use.location, "textures of spheres, disks and cylinders that are not mapped by uv are not read",
        "they are mapped by uv");
  for (const int each : textures) {
    const TextureMapping* own = textures_.mapping_of(each);
    if (own == nullptr || *own != *mapping)
      report.unsupported(use.location,
                         fmt::format("the textures of '{}' are mapped in different ways", shape.name),
                         "they are mapped as the first that is not by uv");
  }
  if (use.placement.node >= 0)
    report.warn_counted(use.location, "textures mapped by position move with their shapes");
  map_mesh(*mesh, *mapping);
}

/// Transforms the shape to world space, or to the space of its object. A mesh without normals becomes
/// `smooth` or faceted. Returns whether it can be rendered. `keys`: the same transform at the start and at
/// the end; a shape that one of them makes another kind is a mesh at all times.
bool ShapeReader::place(Shape& shape, const Placement& placement, const TransformPair& keys, bool smooth,
                        SourceLocation location) {
  const glm::dmat4& to_world = placement.shown;
  ReaderReport& report = context_.report;
  const auto wrong = [&](std::string_view message) {
    report.error(location, message);
    return false;
  };
  if (is_singular(to_world)) return wrong("the transform of this shape flattens it");
  if (++shape_count_ > kMostShapes || triangles_ > kMostTriangles)
    return wrong(fmt::format("more than {} shapes or {} triangles", kMostShapes, kMostTriangles));
  for (const glm::dmat4& each : {to_world, keys.start, keys.end})
    if (is_stretched(shape.geometry, each)) shape.geometry = mesh_of(shape.geometry);
  const auto [x_axis, y_axis] = frame_axes(to_world);
  if (auto* mesh = std::get_if<Mesh>(&shape.geometry)) {
    const bool faceted = mesh->normals.empty() && !smooth;
    if (mesh->normals.empty() && is_mirror(to_world))
      for (glm::uvec3& t : mesh->triangles) std::swap(t.y, t.z);
    if (!report.place(*mesh, to_world, faceted, shape.name, location)) return false;
    triangles_ += mesh->triangles.size();
    return true;
  }
  if (auto* sphere = std::get_if<Sphere>(&shape.geometry)) {
    const double scale = uniform_scale(to_world).value();
    // pbrt's v grows from the lowest point, ours from the highest: the axis is turned round.
    *sphere = {transform_point(to_world, glm::dvec3(0.0)), sphere->radius * scale, x_axis, y_axis,
               (is_mirror(to_world) ? 1.0 : -1.0) * glm::cross(x_axis, y_axis)};
  } else if (auto* disk = std::get_if<Disk>(&shape.geometry)) {
    const double scale = uniform_scale(to_world, 2).value();
    *disk = {transform_point(to_world, disk->center),
             glm::normalize(normal_matrix(to_world) * glm::dvec3(0.0, 0.0, 1.0)), disk->radius * scale,
             x_axis, y_axis};
  } else if (auto* cylinder = std::get_if<Cylinder>(&shape.geometry)) {
    *cylinder = placed_cylinder(*cylinder, to_world).value();
  } else if (auto* curves = std::get_if<Curves>(&shape.geometry)) {
    // A transform that stretches makes the widths those of its mean scale.
    const double scale = std::cbrt(std::abs(glm::determinant(glm::dmat3(to_world))));
    for (Curve& curve : curves->curves)
      for (ControlPoint& point : curve)
        point = {transform_point(to_world, point.position), scale * point.radius};
  }
  if (const auto traceable = check_traceable(shape.geometry); !traceable)
    return wrong(traceable.error().message);
  return true;
}

/// `area`: that of what is one light in pbrt.
void ShapeReader::make_emit(Shape& shape, const AreaLight& light, double area) {
  ReaderReport& report = context_.report;
  if (in_object())
    report.warn_counted(light.location,
                        "area lights of objects are lights wherever their instances are; pbrt refuses them");
  shape.two_sided_emission = light.two_sided;
  double scale = 1.0;
  if (light.power)
    scale = *light.power / (std::numbers::pi * area * (light.two_sided ? 2.0 : 1.0) * light.image_mean);
  shape.radiance = glm::vec3(glm::dvec3(light.radiance) * scale);
  shape.radiance_texture = light.image;
  if (!(std::max({shape.radiance->x, shape.radiance->y, shape.radiance->z}) < 1e37f))
    return report.error(light.location, "the radiance of this light is not finite");
}

}  // namespace penumbra::pbrt
