// Cameras beyond the pinhole: thin lenses with a round or bladed aperture, focused on one plane; parallel
// projection; an optical axis off the film's centre; radial distortion; and chromatic aberration, where each
// channel's image has its own size and focus. The effects are independent of each other: a ray takes one
// after the other, from its point on the film. With chromatic aberration, a sample traces three rays with the
// same random numbers, one for each channel, so that colours have no noise of their own. (One ray of a random
// channel with weight 3 needs three times as many samples for the same noise.) Albedo, normal, depth and
// alpha are those of the green ray.
#ifndef PENUMBRA_LENS_CAMERA_H
#define PENUMBRA_LENS_CAMERA_H
#include "kernels/camera/camera.h"
#include "kernels/math/lane_record.h"

PENUMBRA_NAMESPACE_BEGIN

/// Rays per sample: 3 if the camera has an image for each channel, else 1.
FN int camera_channels(const PRIVATE SceneHeader* h) {
  const bool split = ((SCENE_FEATURES(h) & FEATURE_CAMERA) != 0u) & (h->camera.split != 0.0f);
  return split ? 3 : 1;
}

/// A point relative to the optical axis, in half widths to the left and half heights upwards.
typedef struct {
  float x, y;
} FilmPoint;

/// The film point (dx, dy) pixels off the centre of pixel (x, y), for an image that is magnified by
/// `image_scale`. As in camera_ray, positions relative to the film's centre are integers first.
FN FilmPoint film_point(Camera camera, FilmParameters film, float image_scale, int x, int y, float dx,
                        float dy) {
  const float smaller = 1.0f / image_scale;
  FilmPoint p;
  p.x = -((float)(2 * x + 1 - film.width) + 2.0f * dx) / (float)film.width;
  p.y = -((float)(2 * y + 1 - film.height) + 2.0f * dy) / (float)film.height;
  p.x = (p.x - camera.offset_x) * smaller;
  p.y = (p.y - camera.offset_y) * smaller;
  return p;
}

// Radial distortion (Brown 1971; OpenCV and Mitsuba 0.6's perspective_rdist have the same two terms): what a
// pinhole images at radius r from the axis is imaged at d(r) = r (1 + k1 r^2 + k2 r^4). On the film d grows
// with r, so Newton's method finds the r of a given d within bounds that shrink. The bounds are bisected
// instead where Newton's step leaves them, or where the last step did not halve the remaining error, until
// that is rounding. Of three million random searches, up to the radius where d stops growing, none took more
// than 12 steps.
#define DISTORTION_STEPS 16

// clang-format off
#define DISTORTION_SEARCH_FIELDS(F, a) \
  F(a, float, low)  /* bounds of r */  \
  F(a, float, high)                    \
  F(a, float, r)                       \
  F(a, float, off)  /* |d(r) - d| in the step before */
// clang-format on
LANE_RECORD(DistortionSearch, DistortionSearches, distortion_search, DISTORTION_SEARCH_FIELDS)

FN DistortionSearch start_distortion_search(Camera camera, float d) {
  DistortionSearch s;
  s.low = 0.0f;
  s.high = camera.reach;
  s.r = min_f(d, camera.reach);
  s.off = NO_LIMIT;
  return s;
}

FN DistortionSearch narrowed(Camera camera, float d, DistortionSearch s) {
  const float r2 = s.r * s.r;
  const float excess = s.r * (1.0f + r2 * (camera.k1 + r2 * camera.k2)) - d;
  const float slope = 1.0f + r2 * (3.0f * camera.k1 + r2 * (5.0f * camera.k2));
  DistortionSearch t;
  t.low = excess < 0.0f ? s.r : s.low;
  t.high = excess > 0.0f ? s.r : s.high;
  t.off = FABS(excess);
  const float newton = s.r - excess / max_f(slope, 1e-6f);
  const bool slow = (t.off > 0.5f * s.off) & (t.off > 1e-6f * d);
  const bool inside = (newton >= t.low) & (newton <= t.high) & !slow;
  t.r = inside ? newton : 0.5f * (t.low + t.high);
  return t;
}

/// The tangent of the angle between the axis and the film point, without distortion.
FN float film_radius(Camera camera, float x, float y) {
  return length3(add(scale(camera.x, x), scale(camera.y, y)));
}

/// Moves LANES film points, whose film_radius is `d`, to where they would be without distortion.
STAGE void undistort(Camera camera, const PRIVATE float* RESTRICT d, PRIVATE float* RESTRICT x,
                     PRIVATE float* RESTRICT y) {
  DistortionSearches searches;
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      store_distortion_search(&searches, j, start_distortion_search(camera, d[j]));
    }
  for (int step = 0; step < DISTORTION_STEPS; step++) {
    LANE_LOOP
      for (int j = 0; j < LANES; j++) {
        const DistortionSearch before = load_distortion_search(&searches, j);
        store_distortion_search(&searches, j, narrowed(camera, d[j], before));
      }
  }
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      const bool beside = d[j] > 0.0f;
      const float factor = beside ? searches.r[j] / (beside ? d[j] : 1.0f) : 1.0f;
      x[j] *= factor;
      y[j] *= factor;
    }
}

/// A point on the lens, in lens radii along x and y.
typedef struct {
  float x, y;
} LensPoint;

/// A uniform sample of the lens. A round lens uses the concentric map (Shirley and Chiu 1997); a bladed one
/// uses its triangles about the centre, whose corners lie on the circle.
FN LensPoint lens_point(Camera camera, float u, float v) {
  const float a = 2.0f * u - 1.0f, b = 2.0f * v - 1.0f;
  const bool wide = FABS(a) > FABS(b);
  const float radius = wide ? a : b, other = wide ? b : a;
  const float part = radius != 0.0f ? 0.125f * other / (radius != 0.0f ? radius : 1.0f) : 0.0f;
  float disk_sin, disk_cos;
  sincos_2pi(wide ? part : 0.25f - part, &disk_sin, &disk_cos);

  const float blades = max_f(camera.blades, 3.0f);
  const float place = u * blades;
  const float blade = min_f(floor_f(place), blades - 1.0f);
  float first_sin, first_cos, next_sin, next_cos;
  sincos_2pi(blade / blades + camera.blade_turn, &first_sin, &first_cos);
  sincos_2pi((blade + 1.0f) / blades + camera.blade_turn, &next_sin, &next_cos);
  const float out = SQRT(clamp_f(place - blade, 0.0f, 1.0f));

  const bool disk = camera.blades == 0.0f;
  LensPoint p;
  p.x = disk ? radius * disk_cos : out * mix_f(first_cos, next_cos, v);
  p.y = disk ? radius * disk_sin : out * mix_f(first_sin, next_sin, v);
  return p;
}

/// The ray from `start` along `d`, whose length is that of 1 along the view, between the near and far
/// clipping planes.
FN Ray clipped_ray(Camera camera, vec3 start, vec3 d) {
  Ray r;
  r.origin = add_scaled(start, camera.near_clip, d);
  const float length = length3(d);
  r.direction = scale(d, 1.0f / length);
  r.tmax = min_f((camera.far_clip - camera.near_clip) * length, NO_LIMIT);
  return r;
}

/// The ray from the lens point (lens_x, lens_y) through the film point (x, y), see FilmPoint, between the
/// near and far clipping planes. The lens is in focus at distance `focus` along z. For the centre of the lens
/// and `parallel` 0 it is the ray of camera_ray.
FN Ray lens_ray(Camera camera, float focus, float x, float y, float lens_x, float lens_y) {
  const vec3 on_film = add(scale(camera.x, x), scale(camera.y, y));
  const vec3 on_lens = add(scale(camera.x, lens_x * (camera.lens_radius / length3(camera.x))),
                           scale(camera.y, lens_y * (camera.lens_radius / length3(camera.y))));
  const vec3 d = sub(add(camera.z, scale(on_film, 1.0f - camera.parallel)), scale(on_lens, 1.0f / focus));
  const vec3 start = add(add(camera.origin, scale(on_film, camera.parallel)), on_lens);
  return clipped_ray(camera, start, d);
}

PENUMBRA_NAMESPACE_END
#endif
