#include "tests/gl/pixel_primitives.h"

#include <algorithm>

#include "kernels/camera/camera.h"
#include "kernels/features.h"
#include "kernels/intersect/quadric.h"
#include "kernels/intersect/triangle.h"

namespace penumbra {

std::vector<int> pixel_primitives(const DeviceScene& device_scene) {
  const Scene scene = make_scene(device_scene.header, device_scene.words.data());
  const SceneHeader& h = scene.header;
  const bool look_through = h.integrator.hide_emitters == HIDE_LOOK_THROUGH;
  std::vector<int> primitives;
  for (int y = 0; y < h.film.height; ++y)
    for (int x = 0; x < h.film.width; ++x) {
      const Ray ray = camera_ray(h.camera, h.film, x, y, 0, 0);
      const Shear shear = make_shear(ray.direction);
      float nearest = ray.tmax;
      int seen = -1;
      for (int k = 0; k < h.tables.triangles.count; ++k) {
        const Triangle& t = scene.triangles[k];
        if (look_through && t.light >= 0) continue;
        const TriangleHit hit = intersect_sheared(shear_point(shear, sub(t.p0, ray.origin)),
                                                  shear_point(shear, sub(t.p1, ray.origin)),
                                                  shear_point(shear, sub(t.p2, ray.origin)));
        if (!hit.inside || !(hit.t > 0) || !(hit.t < nearest)) continue;
        nearest = hit.t;
        seen = k;
      }
      for (int k = 0; k < h.tables.quadrics.count; ++k) {
        if (look_through && scene.quadrics[k].light >= 0) continue;
        const float t = intersect_quadric(scene.quadrics[k], ray.origin, ray.direction);
        if (!(t > 0) || !(t < nearest)) continue;
        nearest = t;
        seen = h.tables.triangles.count + k;
      }
      primitives.push_back(seen);
    }
  return primitives;
}

std::vector<char> pixels_off_silhouettes(const DeviceScene& scene) {
  const std::vector<int> primitives = pixel_primitives(scene);
  const int width = scene.header.film.width, height = scene.header.film.height;
  std::vector<char> inside;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      bool same = true;
      for (int v = std::max(y - 1, 0); v <= std::min(y + 1, height - 1); ++v)
        for (int u = std::max(x - 1, 0); u <= std::min(x + 1, width - 1); ++u)
          same &= primitives[std::size_t(v) * width + u] == primitives[std::size_t(y) * width + x];
      inside.push_back(same ? 1 : 0);
    }
  return inside;
}

std::vector<char> pixels_on_polygon_lights(const DeviceScene& device_scene) {
  const Scene scene = make_scene(device_scene.header, device_scene.words.data());
  std::vector<char> on_light;
  for (const int primitive : pixel_primitives(device_scene)) {
    const bool is_triangle = primitive >= 0 && primitive < scene.header.tables.triangles.count;
    const int light = is_triangle ? scene.triangles[primitive].light : -1;
    on_light.push_back(light >= 0 && scene.lights[light].polygon >= 0 ? 1 : 0);
  }
  return on_light;
}

}  // namespace penumbra
