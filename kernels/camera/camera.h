// The pinhole camera.
#ifndef PENUMBRA_CAMERA_H
#define PENUMBRA_CAMERA_H
#include "kernels/math/math.h"
#include "kernels/scene_types.h"

PENUMBRA_NAMESPACE_BEGIN

typedef struct {
  vec3 origin;
  vec3 direction;  ///< unit
  float tmax;
} Ray;

/// The ray through the point (dx, dy) pixels off the centre of pixel (x, y), between the near and far
/// clipping planes. Pixel positions relative to the film's centre are computed in integers first, so that
/// wide films keep their sub-pixel bits.
FN Ray camera_ray(Camera camera, FilmParameters film, int x, int y, float dx, float dy) {
  float sx = -((float)(2 * x + 1 - film.width) + 2.0f * dx) / (float)film.width;
  float sy = -((float)(2 * y + 1 - film.height) + 2.0f * dy) / (float)film.height;
  vec3 d = add(camera.z, add(scale(camera.x, sx), scale(camera.y, sy)));
  Ray r;
  r.origin = add_scaled(camera.origin, camera.near_clip, d);
  float length = length3(d);
  r.direction = scale(d, 1.0f / length);
  r.tmax = min_f((camera.far_clip - camera.near_clip) * length, NO_LIMIT);
  return r;
}

PENUMBRA_NAMESPACE_END
#endif
