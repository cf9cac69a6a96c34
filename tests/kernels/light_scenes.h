// Scenes of one light that is also a primitive, for tests of light sampling.
#pragma once

#include <string>

#include "tests/kernels/kernels_under_test.h"
#include "tests/kernels/scene_tables.h"

namespace penumbra {

/// The only light of a scene, all but its place and shape.
inline Light only_light(int kind) {
  Light light{};
  light.kind = kind;
  light.pmf = 1;
  light.polygon = -1;
  light.radiance = make_vec3(1, 2, 3);
  return light;
}

inline SceneTables triangle_light(const vec3& a, const vec3& b, const vec3& c, bool by_solid_angle) {
  SceneTables tables;
  tables.header.features = by_solid_angle ? FEATURE_SOLID_ANGLE : 0;
  tables.header.environment = -1;
  tables.add_triangle(a, b, c);
  tables.triangles[0].light = 0;
  Light light = only_light(LIGHT_TRIANGLE);
  light.p0 = a;
  light.p1 = b;
  light.p2 = c;
  light.area = float(0.5L * length(cross(exact(b) - exact(a), exact(c) - exact(a))));
  light.sampling = by_solid_angle ? EMITTER_SOLID_ANGLE : EMITTER_AREA;
  tables.lights.push_back(light);
  return tables;
}

inline SceneTables quadric_light(const Quadric& quadric, bool by_solid_angle) {
  SceneTables tables;
  tables.header.environment = -1;
  tables.quadrics.push_back(quadric);
  tables.quadrics[0].light = 0;
  const bool sphere = quadric.kind == QUADRIC_SPHERE, cylinder = quadric.kind == QUADRIC_CYLINDER;
  Light light = only_light(sphere ? LIGHT_SPHERE : cylinder ? LIGHT_CYLINDER : LIGHT_DISK);
  light.p0 = quadric.center;
  light.p1 = quadric.normal;
  light.p2 = make_vec3(quadric.radius, quadric.orientation, cylinder ? quadric.length : 0);
  light.area =
      cylinder ? 2 * PI_F * quadric.radius * quadric.length : (sphere ? 4 : 1) * PI_F * sqr(quadric.radius);
  light.sampling = by_solid_angle ? EMITTER_SOLID_ANGLE : EMITTER_AREA;
  tables.lights.push_back(light);
  return tables;
}

/// Its frame is about `pole`: the normal of a disk, the axis of a cylinder.
inline Quadric quadric_about(int kind, const vec3& center, const vec3& pole, float radius,
                             float orientation) {
  Quadric q{};
  q.kind = kind;
  q.center = center;
  q.normal = pole;
  q.radius = radius;
  q.orientation = orientation;
  q.x_axis = from_frame(pole, 1, 0, 0);
  q.y_axis = from_frame(pole, 0, 1, 0);
  return q;
}

inline SceneTables sphere_light(const vec3& center, float radius, float orientation, bool by_solid_angle) {
  return quadric_light(quadric_about(QUADRIC_SPHERE, center, make_vec3(0, 0, 1), radius, orientation),
                       by_solid_angle);
}

inline SceneTables disk_light(const vec3& center, const vec3& normal, float radius) {
  return quadric_light(quadric_about(QUADRIC_DISK, center, normal, radius, 1), false);
}

inline SceneTables cylinder_light(const vec3& end, const vec3& axis, float radius, float length,
                                  float orientation) {
  Quadric q = quadric_about(QUADRIC_CYLINDER, end, axis, radius, orientation);
  q.length = length;
  return quadric_light(q, false);
}

inline SceneTables environment_light() {
  SceneTables tables;
  tables.header.environment = 0;
  tables.lights.push_back(only_light(LIGHT_ENVIRONMENT));
  return tables;
}

inline SceneTables point_light(const vec3& position) {
  SceneTables tables;
  tables.header.environment = -1;
  Light light = only_light(LIGHT_POINT);
  light.p0 = position;
  tables.lights.push_back(light);
  return tables;
}

/// The corner and those next and previous to it. It is no primitive.
inline SceneTables rectangle_light(const vec3& corner, const vec3& next, const vec3& previous) {
  SceneTables tables = triangle_light(corner, next, previous, true);
  tables.lights[0].kind = LIGHT_RECTANGLE;
  tables.lights[0].area *= 2;
  return tables;
}

/// A receiver at `p` that faces `normal`, its position rounded like a real one's.
inline Surface receiver(const vec3& p, const vec3& normal) {
  Surface s = surface_in_medium(p);
  s.front = true;
  s.geometric = s.shading = normal;
  s.error = POSITION_ERROR * dot3(abs3(normal), abs3(p));
  return s;
}

/// One receiver's sample, by all lanes.
inline LightSample sample_light(const Scene& scene, const Surface& r, float u, float v, float fine) {
  Surfaces receivers;
  LightSamples samples;
  LightSamplings samplings;
  float number[LANES], other[LANES], digits[LANES];
  for (int j = 0; j < LANES; ++j) {
    store_surface(&receivers, j, r);
    number[j] = u, other[j] = v, digits[j] = fine;
  }
  clear_light_samplings(&samplings);
  sample_lights(&scene, &receivers, number, other, digits, &samplings, &samples);
  return load_light_sample(&samples, 0);
}

/// What a ray finds of lights where it ends on the surface; of the first sun, if the scene has suns.
inline Emission emission_at(const Scene& scene, const Surface& s) {
  Surfaces surfaces;
  FoundLights found;
  Emissions emissions;
  for (int j = 0; j < LANES; ++j) store_surface(&surfaces, j, s);
  if (scene.header.sun_count > 0)
    finds_sun(&scene, scene.header.first_sun, &surfaces, &found);
  else
    find_lights(&scene, &surfaces, &found);
  find_emissions(&scene, &found, true, &emissions);
  return load_emission(&emissions, 0);
}

/// Van Oosterom and Strackee 1983.
inline double exact_solid_angle(const Exact3& a, const Exact3& b, const Exact3& c) {
  const Exact3 u = normalize(a), v = normalize(b), w = normalize(c);
  // By edges, which keeps small triangles' digits.
  const long double determinant = std::abs(dot(u, cross(v - u, w - u)));
  return double(2 * std::atan2(determinant, 1 + dot(u, v) + dot(v, w) + dot(w, u)));
}

}  // namespace penumbra
