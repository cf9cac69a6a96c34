// The layer of motion: by how many pixels what a pixel shows moves between frames.
#ifndef PENUMBRA_MOTION_LAYER_H
#define PENUMBRA_MOTION_LAYER_H
#include "kernels/camera/lens_camera.h"
#include "kernels/camera/panorama_camera.h"
#include "kernels/motion/moving_surface.h"
#include "kernels/motion/shutter.h"

PENUMBRA_NAMESPACE_BEGIN

/// A position on the film in pixels from its upper left corner, in the image of the green channel.
typedef struct {
  float x, y;
  bool seen;  ///< false: no part of the image shows it
} FilmPosition;

/// The inverse of lens_ray through the lens's centre. `v`: a position relative to the camera, or a direction
/// to a point at infinity (`far`).
FN FilmPosition film_position(Camera camera, FilmParameters film, vec3 v, bool far) {
  const float depth = dot3(v, camera.z);
  const float divisor = camera.parallel != 0.0f ? 1.0f : depth;
  FilmPosition f;
  f.seen = (depth > 0.0f) & !(far & (camera.parallel != 0.0f));
  const float inverse = 1.0f / (f.seen ? divisor : 1.0f);
  float x = dot3(v, camera.x) / dot3(camera.x, camera.x) * inverse;
  float y = dot3(v, camera.y) / dot3(camera.y, camera.y) * inverse;
  if (HAS(CAMERA)) {
    const float r2 = camera.reach > 0.0f ? sqr(film_radius(camera, x, y)) : 0.0f;
    const float factor = 1.0f + r2 * (camera.k1 + r2 * camera.k2);
    const float size = factor * (camera.image_scale.y != 0.0f ? camera.image_scale.y : 1.0f);
    x = x * size + camera.offset_x;
    y = y * size + camera.offset_y;
  }
  f.x = 0.5f * (float)film.width * (1.0f - x);
  f.y = 0.5f * (float)film.height * (1.0f - y);
  return f;
}

/// The same of a panorama, in the picture that has the row y.
FN FilmPosition panorama_position(Camera camera, FilmParameters film, vec3 v, bool far, int y) {
  const PanoramaImage image = panorama_image(camera, v, far, eye_of_row(camera, film, y));
  const int height = panorama_height(camera, film);
  FilmPosition f;
  f.x = 0.5f * (float)film.width * (1.0f - image.point.x);
  f.y = 0.5f * (float)height * (1.0f - image.point.y) + (y < height ? 0.0f : (float)height);
  f.seen = image.seen;
  return f;
}

/// Where the film shows, at `time`, what the camera ray of a pixel in row y met at `s`; if that is nothing,
/// its direction.
FN FilmPosition film_position_at(const PRIVATE Scene* scene, Surface s, int y, float time) {
  Camera camera = scene->header.camera;
  if (camera_moves(scene)) camera = camera_at(scene, camera, time);
  const vec3 v = is_hit(s) ? sub(position_at(scene, s, time), camera.origin) : negate(s.wo);
  if (NEEDS_PANORAMA(scene)) return panorama_position(camera, scene->header.film, v, !is_hit(s), y);
  return film_position(camera, scene->header.film, v, !is_hit(s));
}

/// The motion from the middle of the frame to that of another, in pixels to the right and down; 0 if the
/// camera does not see both. Round a panorama it is the shorter way.
FN vec3 motion_to(const PRIVATE Scene* scene, Surface s, int y, FilmPosition now, float time) {
  const FilmPosition then = film_position_at(scene, s, y, time);
  const float period =
      NEEDS_PANORAMA(scene) ? panorama_period(scene->header.camera, scene->header.film) : 0.0f;
  const float right = then.x - now.x;
  const float turns = period > 0.0f ? floor_f(right / (period > 0.0f ? period : 1.0f) + 0.5f) : 0.0f;
  const vec3 moved = make_vec3(right - turns * period, then.y - now.y, 0.0f);
  return select3(now.seen & then.seen & is_finite3(moved), moved, make_vec3(0.0f, 0.0f, 0.0f));
}

/// Of the camera rays' hits.
STAGE void record_motion(const PRIVATE Scene* scene, const PRIVATE Surfaces* RESTRICT surfaces,
                         const PRIVATE PathState* paths, int i, const PRIVATE SlotState* slots) {
  for (int j = 0; j < LANES; j++) {  // no lane loop: slots are scattered
    Surface s = load_surface(surfaces, j);
    if (!NEEDS(scene, INSTANCES)) s.instance = -1;
    const int slot = get_slot(paths, i + j), y = get_film_y(paths, i + j);
    const FilmPosition now = film_position_at(scene, s, y, MIDDLE_TIME);
    set_slot_motion_before(slots, slot, motion_to(scene, s, y, now, BEFORE_FRAME));
    set_slot_motion_after(slots, slot, motion_to(scene, s, y, now, AFTER_FRAME));
  }
}

PENUMBRA_NAMESPACE_END
#endif
