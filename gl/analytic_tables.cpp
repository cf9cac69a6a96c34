#include "gl/analytic_tables.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <vector>

#include "kernels/host/device_scene.h"
#include "scenes/device/ltc/control_knots.h"

namespace penumbra {
namespace {

float largest(vec3 v) { return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)}); }

/// The largest power of two that is at most the largest coordinate.
float unit_of(const DeviceScene& scene) {
  const SceneHeader& h = scene.header;
  float most = 0;
  for (const Triangle& t : table<Triangle>(scene, h.tables.triangles))
    most = std::max({most, largest(t.p0), largest(t.p1), largest(t.p2)});
  for (const Quadric& q : table<Quadric>(scene, h.tables.quadrics))
    most = std::max(most, largest(q.center) + q.radius);
  return most > 0 && std::isfinite(most) ? std::ldexp(1.0f, std::ilogb(most)) : 1.0f;
}

/// Packs numbers into the words of texels.
class Packer {
 public:
  explicit Packer(float unit) : scale_(1 / unit) {}
  void number(float x) { words_.push_back(std::bit_cast<std::uint32_t>(x)); }
  void number(int x) { words_.push_back(static_cast<std::uint32_t>(x)); }
  void length(float x) { number(x * scale_); }
  void vector(vec3 v) {
    number(v.x);
    number(v.y);
    number(v.z);
  }
  void point(vec3 p) { vector({p.x * scale_, p.y * scale_, p.z * scale_}); }

  /// Four words per texel: floats, or integers among them.
  [[nodiscard]] Expected<BufferTexture> upload(std::string_view what, GLenum format) const {
    return make_buffer_texture(what, std::as_bytes(std::span(words_)), format, 4 * sizeof(std::uint32_t));
  }

 private:
  float scale_;
  std::vector<std::uint32_t> words_;
};

Expected<BufferTexture> pack_triangles(const DeviceScene& scene, float unit) {
  Packer p(unit);
  const auto lights = table<Light>(scene, scene.header.tables.lights);
  for (const Triangle& t : table<Triangle>(scene, scene.header.tables.triangles)) {
    p.point(t.p0);
    p.number(t.front);
    p.point(t.p1);
    p.number(t.back);
    p.point(t.p2);
    p.number(t.light);
    const int polygon = t.light >= 0 ? lights[static_cast<std::size_t>(t.light)].polygon : -1;
    for (const int word : {t.normals, polygon, 0, 0}) p.number(word);
  }
  return p.upload("the triangles", GL_RGBA32UI);
}

Expected<BufferTexture> pack_normals(const DeviceScene& scene) {
  Packer p(1);
  for (const VertexNormals& n : table<VertexNormals>(scene, scene.header.tables.normals))
    for (const vec3& normal : {n.n0, n.n1, n.n2}) {
      p.vector(normal);
      p.number(0.0f);
    }
  return p.upload("the vertex normals", GL_RGBA32F);
}

Expected<BufferTexture> pack_quadrics(const DeviceScene& scene, float unit) {
  Packer p(unit);
  for (const Quadric& q : table<Quadric>(scene, scene.header.tables.quadrics)) {
    p.point(q.center);
    p.length(q.radius);
    p.vector(q.normal);
    p.number(q.orientation);
    for (const int word : {q.kind, q.front, q.back, q.light}) p.number(word);
  }
  return p.upload("the spheres and disks", GL_RGBA32UI);
}

Expected<BufferTexture> pack_materials(const DeviceScene& scene) {
  Packer p(1);
  for (const Material& each : table<Material>(scene, scene.header.tables.materials)) {
    // Materials without a closed form reflect nothing.
    const Material m = (families_with(CLOSED_FORM) >> each.family & 1u) != 0u ? each : Material{};
    p.vector(m.diffuse);
    p.number(m.exponent);
    p.vector(m.specular);
    p.number(m.family == FAMILY_PHONG ? 1.0f : 0.0f);
  }
  return p.upload("the materials", GL_RGBA32F);
}

Expected<BufferTexture> pack_control_lobes(const DeviceScene& scene) {
  static_assert(kControlKnots == 125, "as CONTROL_KNOTS of analytic_shade.frag");
  Packer p(1);
  for (const ControlKnot& knot : control_knots(scene)) {
    p.vector(knot.diffuse);
    p.number(knot.lean);
    p.vector(knot.specular);
    p.number(knot.width_x);
    for (const float word : {knot.width_y, 0.0f, 0.0f, 0.0f}) p.number(word);
  }
  return p.upload("the control lobes of the materials", GL_RGBA32F);
}

Expected<BufferTexture> pack_lights(const DeviceScene& scene) {
  Packer p(1);
  for (const Light& light : table<Light>(scene, scene.header.tables.lights)) {
    p.vector(light.unseen == UNSEEN_BY_CAMERA ? vec3{0.0f, 0.0f, 0.0f} : light.radiance);
    p.number(light.two_sided != 0 ? 1.0f : 0.0f);
  }
  return p.upload("the lights", GL_RGBA32F);
}

Expected<BufferTexture> pack_polygons(const DeviceScene& scene) {
  Packer p(1);
  for (const Polygon& polygon : table<Polygon>(scene, scene.header.tables.polygons)) {
    p.vector(polygon.radiance);
    p.number(polygon.two_sided);
    for (const int word : {polygon.first_corner, polygon.corner_count, 0, 0}) p.number(word);
  }
  return p.upload("the polygon lights", GL_RGBA32UI);
}

Expected<BufferTexture> pack_corners(const DeviceScene& scene, float unit) {
  Packer p(unit);
  for (const PolygonCorner& c : table<PolygonCorner>(scene, scene.header.tables.polygon_corners)) {
    p.point(c.p);
    p.number(c.starts != 0 ? 1.0f : 0.0f);
  }
  return p.upload("the corners of the polygon lights", GL_RGBA32F);
}

}  // namespace

Expected<AnalyticTables> make_analytic_tables(const DeviceScene& scene) {
  AnalyticTables made;
  made.unit = unit_of(scene);
  // The first error is returned.
  Expected<void> done;
  const auto take = [&done](BufferTexture& target, Expected<BufferTexture> packed) {
    if (packed)
      target = std::move(*packed);
    else if (done)
      done = std::unexpected(packed.error());
  };
  take(made.triangles, pack_triangles(scene, made.unit));
  take(made.quadrics, pack_quadrics(scene, made.unit));
  take(made.vertex_normals, pack_normals(scene));
  take(made.materials, pack_materials(scene));
  if ((scene.header.features & FEATURE_LTC) != 0) take(made.control_lobes, pack_control_lobes(scene));
  take(made.lights, pack_lights(scene));
  take(made.polygons, pack_polygons(scene));
  take(made.polygon_corners, pack_corners(scene, made.unit));
  if (!done) return std::unexpected(done.error());
  return made;
}

}  // namespace penumbra
