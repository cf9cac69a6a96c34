// Panoramic cameras: projections of directions that no plane holds. Camera space is that of the other
// cameras: x to the left, y up, z forwards, where the film's centre looks unless its range of angles is
// elsewhere. Each projection has coordinates that are linear on the film, see PANORAMA_* and the camera's
// center and half; film points beyond the film continue round the sphere, so that a pixel's filter reaches
// across the seam. The lens is a disk perpendicular to the ray, and in focus at a distance along it.
//
// A camera with two eyes is that of omni-directional stereo (Google, "Rendering omni-directional stereo
// content", 2015): the rays of an eye touch a circle about the camera, horizontally, with half the distance
// of the eyes as its radius. The left eye's picture is above the right eye's.
#ifndef PENUMBRA_PANORAMA_CAMERA_H
#define PENUMBRA_PANORAMA_CAMERA_H
#include "kernels/camera/lens_camera.h"

PENUMBRA_NAMESPACE_BEGIN

#define TURN_OF_RADIAN 0.15915494309f

/// A direction that the film shows.
typedef struct {
  vec3 direction;  ///< unit, in camera space
  bool seen;       ///< false: beyond the circle of a fisheye
} PanoramaView;

/// Where the film shows a point.
typedef struct {
  FilmPoint point;
  bool seen;  ///< false: no picture shows it
} PanoramaImage;

/// The height of one picture in pixels.
FN int panorama_height(Camera camera, FilmParameters film) {
  return camera.pictures > 1.0f ? film.height / 2 : film.height;
}

/// How far to the left the eye is whose picture contains the row.
FN float eye_of_row(Camera camera, FilmParameters film, int y) {
  return y < panorama_height(camera, film) ? camera.eye : -camera.eye;
}

/// The point (dx, dy) pixels off the centre of pixel (x, y) in its picture.
FN FilmPoint panorama_point(Camera camera, FilmParameters film, int x, int y, float dx, float dy) {
  FilmParameters picture = film;
  picture.height = panorama_height(camera, film);
  const int row = y < picture.height ? y : y - picture.height;
  return film_point(camera, picture, 1.0f, x, row, dx, dy);
}

/// The equal-area map from the square [-1, 1]^2 to the sphere; its middle is +z, its corners are -z (Clarberg
/// 2008, "Fast equal-area mapping of the (hemi)sphere using SIMD"). Beyond an edge the map goes on at the
/// point of the same edge that is as far from its middle on the other side.
FN vec3 equal_area_direction(float x, float y) {
  const bool over_x = FABS(x) > 1.0f;
  const float inner_x = over_x ? (x < 0.0f ? -2.0f : 2.0f) - x : x, turned_y = over_x ? -y : y;
  const bool over_y = FABS(turned_y) > 1.0f;
  const float inner_y = over_y ? (turned_y < 0.0f ? -2.0f : 2.0f) - turned_y : turned_y;
  const float a = clamp_f(over_y ? -inner_x : inner_x, -1.0f, 1.0f), b = clamp_f(inner_y, -1.0f, 1.0f);
  const float u = FABS(a), v = FABS(b);
  const float d = 1.0f - (u + v), r = 1.0f - FABS(d);
  float s, c;
  sincos_2pi(0.125f * (r > 0.0f ? (v - u) / r + 1.0f : 1.0f), &s, &c);
  const float height = 1.0f - r * r, radius = r * safe_sqrt(2.0f - r * r);
  return make_vec3(a < 0.0f ? -c * radius : c * radius, b < 0.0f ? -s * radius : s * radius,
                   d < 0.0f ? -height : height);
}

/// Its inverse, for a unit direction.
FN FilmPoint equal_area_point(vec3 d) {
  const float x = FABS(d.x), y = FABS(d.y), across = x * x + y * y;
  const float r = safe_sqrt(across / (1.0f + FABS(d.z)));
  const float part = atan2_f(min_f(x, y), max_f(x, y)) * (4.0f * TURN_OF_RADIAN);
  const float v = (x < y ? 1.0f - part : part) * r, u = r - v;
  const float a = d.z < 0.0f ? 1.0f - v : u, b = d.z < 0.0f ? 1.0f - u : v;
  FilmPoint p;
  p.x = d.x < 0.0f ? -a : a;
  p.y = d.y < 0.0f ? -b : b;
  return p;
}

/// The direction that the film shows at a point.
FN PanoramaView panorama_view(Camera camera, FilmPoint p) {
  const int kind = (int)camera.panorama;
  const float x = camera.center_x + camera.half_x * p.x, y = camera.center_y + camera.half_y * p.y;
  PanoramaView view;
  view.seen = true;
  if (kind == PANORAMA_EQUAL_AREA) {
    view.direction = equal_area_direction(x, y);
    return view;
  }
  float s, c;
  if ((kind == PANORAMA_EQUIDISTANT) | (kind == PANORAMA_EQUISOLID)) {
    const float r = SQRT(x * x + y * y);
    view.seen = r <= camera.limit;
    sincos_2pi(r, &s, &c);
    const float of_angle = r > 0.0f ? s / (r > 0.0f ? r : 1.0f) : 0.0f;
    const bool equisolid = kind == PANORAMA_EQUISOLID;
    const float out = equisolid ? 2.0f * safe_sqrt(1.0f - r * r) : of_angle;
    view.direction = make_vec3(x * out, y * out, equisolid ? 1.0f - 2.0f * r * r : c);
    // Beyond the circle any direction does.
    view.direction = select3(view.seen, view.direction, make_vec3(0.0f, 0.0f, 1.0f));
    return view;
  }
  sincos_2pi(x, &s, &c);
  if (kind == PANORAMA_CYLINDRICAL) {
    view.direction = normalize3(make_vec3(s, y, c));
    return view;
  }
  float sin_latitude, cos_latitude;
  sincos_2pi(y, &sin_latitude, &cos_latitude);
  view.direction = make_vec3(s * cos_latitude, sin_latitude, c * cos_latitude);
  return view;
}

/// The horizontal direction to the left of a direction of camera space.
FN vec3 left_of(vec3 d) {
  const float across = SQRT(d.x * d.x + d.z * d.z);
  const float inverse = 1.0f / (across > 0.0f ? across : 1.0f);
  return across > 0.0f ? make_vec3(d.z * inverse, 0.0f, -d.x * inverse) : make_vec3(1.0f, 0.0f, 0.0f);
}

FN vec3 from_camera_space(Camera camera, vec3 v) {
  return add(add(scale(camera.x, v.x), scale(camera.y, v.y)), scale(camera.z, v.z));
}

/// The ray along a unit direction of camera space, from the eye (eye_of_row) and a point of the lens, between
/// the near and far clipping distances.
FN Ray panorama_ray(Camera camera, float focus, vec3 direction, float eye, LensPoint lens) {
  const vec3 left = left_of(direction), up = cross3(direction, left);
  const vec3 on_lens = add(scale(left, lens.x * camera.lens_radius), scale(up, lens.y * camera.lens_radius));
  const vec3 start = add(scale(left, eye), on_lens);
  return clipped_ray(camera, add(camera.origin, from_camera_space(camera, start)),
                     from_camera_space(camera, sub(direction, scale(on_lens, 1.0f / focus))));
}

/// The inverse of panorama_ray through the lens's centre. `v`: a position in the world relative to the
/// camera, or a direction to a point at infinity (`far`).
FN PanoramaImage panorama_image(Camera camera, vec3 v, bool far, float eye) {
  const int kind = (int)camera.panorama;
  const float x = dot3(v, camera.x) / dot3(camera.x, camera.x),
              y = dot3(v, camera.y) / dot3(camera.y, camera.y), z = dot3(v, camera.z);
  const float length = SQRT(x * x + y * y + z * z), inverse = 1.0f / (length > 0.0f ? length : 1.0f);
  PanoramaImage image;
  image.seen = length > 0.0f;
  FilmPoint p;  // in the projection's coordinates
  if (kind == PANORAMA_EQUAL_AREA) {
    p = equal_area_point(make_vec3(x * inverse, y * inverse, z * inverse));
  } else if ((kind == PANORAMA_EQUIDISTANT) | (kind == PANORAMA_EQUISOLID)) {
    const float across = SQRT(x * x + y * y), cosine = z * inverse;
    const float divisor = across > 0.0f ? across : 1.0f;
    // The sine of half the angle is that of the angle over twice the cosine of half.
    const float half_sine =
        cosine > 0.0f ? across * inverse / SQRT(2.0f * (1.0f + cosine)) : SQRT(0.5f * (1.0f - cosine));
    const float r = kind == PANORAMA_EQUISOLID ? half_sine : atan2_f(across, z) * TURN_OF_RADIAN;
    image.seen = image.seen & (r <= camera.limit);
    p.x = x / divisor * r;
    p.y = y / divisor * r;
  } else {
    const float across2 = x * x + z * z;
    const float ahead =
        safe_sqrt(far ? across2 : across2 - eye * eye);  // from where the ray touches the circle
    const float longitude = atan2_f(x, z) - (far ? 0.0f : atan2_f(eye, ahead));
    const float off = longitude * TURN_OF_RADIAN - camera.center_x;
    p.x = camera.center_x + (off - floor_f(off + 0.5f));
    image.seen = image.seen & (kind == PANORAMA_CYLINDRICAL ? ahead > 0.0f : far | (across2 >= eye * eye));
    p.y =
        kind == PANORAMA_CYLINDRICAL ? y / (ahead > 0.0f ? ahead : 1.0f) : atan2_f(y, ahead) * TURN_OF_RADIAN;
  }
  image.point.x = (p.x - camera.center_x) / camera.half_x + camera.offset_x;
  image.point.y = (p.y - camera.center_y) / camera.half_y + camera.offset_y;
  return image;
}

/// By how many pixels to the right a panorama repeats itself; 0: it does not.
FN float panorama_period(Camera camera, FilmParameters film) {
  const int kind = (int)camera.panorama;
  const bool turns = (kind == PANORAMA_EQUIRECTANGULAR) | (kind == PANORAMA_CYLINDRICAL);
  return turns ? 0.5f * (float)film.width / camera.half_x : 0.0f;
}

PENUMBRA_NAMESPACE_END
#endif
