#include "scenes/device/light_media.h"

#include <algorithm>
#include <cmath>

#include "kernels/intersect/surface.h"
#include "kernels/light/flat_light.h"
#include "kernels/medium/medium_stack.h"
#include "scenes/device/records_view.h"

namespace penumbra {
namespace {

constexpr float kJustOutside = 1e-3f;    // in sizes of the light: its own surface may bound a medium
constexpr int kMostCrossings = 1 << 16;  // of one way; rounding must not make it endless

/// A primitive that bounds a medium; `instance` is -1 for one that is not instanced.
struct BoundaryPrimitive {
  int primitive, instance;
};

std::vector<BoundaryPrimitive> boundary_primitives(const Scene& scene, const SceneRecords& records) {
  const int triangles = int(records.triangles.size()), quadrics = int(records.quadrics.size());
  std::vector<BoundaryPrimitive> found;
  const auto add = [&](int first, int count, int instance) {
    for (int i = first; i < first + count; ++i)
      if (boundary_of(&scene, i) >= 0) found.push_back({i, instance});
  };
  const auto add_group = [&](const PrimitiveGroup& group, int instance) {
    add(group.first_triangle, group.triangle_count, instance);
    add(triangles + group.first_quadric, group.quadric_count, instance);
  };
  if (records.groups.empty()) {
    add(0, triangles + quadrics, -1);
    return found;
  }
  add_group(records.groups.front(), -1);
  for (std::size_t i = 0; i < records.instances.size(); ++i)
    add_group(records.groups[std::size_t(records.instances[i].group)], int(i));
  return found;
}

/// The distance to the primitive along the ray, or NO_LIMIT.
float distance_to(const Scene& scene, const BoundaryPrimitive& each, vec3 o, vec3 d) {
  const int triangles = scene.header.tables.triangles.count;
  float stretch = 1.0f;
  if (each.instance >= 0) {
    const GroupRay ray = group_ray(scene.instances[each.instance], o, d);
    const UnitDirection unit = unit_direction(ray.d);
    o = ray.o;
    d = unit.d;
    stretch = unit.length;
  }
  float t = -1.0f;
  if (each.primitive < triangles) {
    const Triangle& triangle = scene.triangles[each.primitive];
    const Shear shear = make_shear(d);
    const TriangleHit hit =
        intersect_sheared(shear_point(shear, sub(triangle.p0, o)), shear_point(shear, sub(triangle.p1, o)),
                          shear_point(shear, sub(triangle.p2, o)));
    if (hit.inside && hit.det != 0.0f) t = hit.t;
  } else {
    const Quadric& q = scene.quadrics[each.primitive - triangles];
    t = q.kind == QUADRIC_CYLINDER ? intersect_cylinder(o, d, q.center, q.normal, q.radius, q.length)
                                   : intersect_sphere_or_disk(q, o, d);
  }
  return t > 0.0f ? t / stretch : NO_LIMIT;
}

/// The media at the end of the way from `o` to `to`, which starts in `media`.
MediumStack media_at(const Scene& scene, const std::vector<BoundaryPrimitive>& primitives, MediumStack media,
                     vec3 o, vec3 to) {
  const BoundaryPrimitive* last = nullptr;
  for (int k = 0; k < kMostCrossings; ++k) {
    const vec3 way = sub(to, o);
    const float length = length3(way);
    if (!(length > 0.0f)) break;
    const vec3 d = scale(way, 1.0f / length);
    const BoundaryPrimitive* nearest = nullptr;
    float least = length;
    for (const BoundaryPrimitive& each : primitives) {
      const bool flat = each.primitive < scene.header.tables.triangles.count;
      if (flat && &each == last) continue;
      if (const float t = distance_to(scene, each, o, d); t < least) {
        least = t;
        nearest = &each;
      }
    }
    if (nearest == nullptr) break;
    const Surface s = nearest->instance >= 0
                          ? surface_at_instance(&scene, nearest->primitive, nearest->instance, o, d)
                          : surface_at(&scene, nearest->primitive, o, d);
    media = cross_boundary(&scene, boundary_of(&scene, nearest->primitive), s.front, media).media;
    o = leave_surface(s.p, s.geometric, s.error, d);
    last = nearest;
  }
  return media;
}

/// A point just before the surface that emits, or of the light itself.
vec3 emitting_point(const Scene& scene, const Light& light) {
  switch (light.kind) {
    case LIGHT_TRIANGLE:
    case LIGHT_RECTANGLE: {
      const FlatLight flat = flat_light(light);
      const vec3 middle = scale(add(flat.p1, flat.p2), 0.5f);
      const vec3 centre =
          light.kind == LIGHT_TRIANGLE ? scale(add(add(flat.p0, flat.p1), flat.p2), 1.0f / 3.0f) : middle;
      return add_scaled(centre, kJustOutside * std::sqrt(light.area), flat.normal);
    }
    case LIGHT_SPHERE:
      return add_scaled(light.p0, light.p2.x * (1.0f + light.p2.y * kJustOutside), make_vec3(0, 0, 1));
    case LIGHT_DISK:
      return add_scaled(light.p0, light.p2.x * kJustOutside, light.p1);
    case LIGHT_CYLINDER: {
      const vec3 middle = add_scaled(light.p0, 0.5f * light.p2.z, light.p1);
      return add_scaled(middle, light.p2.x * (1.0f + light.p2.y * kJustOutside),
                        from_frame(light.p1, 1.0f, 0.0f, 0.0f));
    }
    default:
      return light.p0;
  }
}

}  // namespace

std::vector<LightMedia> light_media(const SceneHeader& header, const SceneRecords& records) {
  const RecordsView view(records, header);
  const Scene& scene = view.scene();
  const std::vector<BoundaryPrimitive> primitives = boundary_primitives(scene, records);
  const MediumStack of_camera = {std::uint32_t(header.camera_medium), 0};
  const float radius = header.integrator.emission_radius;
  const vec3 outside = add_scaled(header.camera.origin, 2 * (radius + length3(header.camera.origin)),
                                  normalize3(make_vec3(1.0f, 0.7f, 0.4f)));
  std::vector<LightMedia> media;
  for (const Light& light : records.lights) {
    if (primitives.empty()) {
      media.push_back({of_camera.low, of_camera.high});
      continue;
    }
    const vec3 to = is_infinite_light(light.kind) ? outside : emitting_point(scene, light);
    const MediumStack at = media_at(scene, primitives, of_camera, header.camera.origin, to);
    media.push_back({at.low, at.high});
  }
  return media;
}

}  // namespace penumbra
