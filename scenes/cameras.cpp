#include "scenes/cameras.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "scenes/panoramas.h"
#include "scenes/scene_description.h"
#include "scenes/view_angle.h"

namespace penumbra {
namespace {

/// The distorted radius of r.
double distorted(const CameraSettings& camera, double r) {
  return r * (1 + r * r * (camera.distortion_k1 + r * r * camera.distortion_k2));
}

/// The smallest r beyond which distorted(r) decreases, if there is one: the smallest root of its derivative,
/// 1 + 3 k1 r^2 + 5 k2 r^4.
std::optional<double> fold(const CameraSettings& camera) {
  const double b = 3 * camera.distortion_k1, a = 5 * camera.distortion_k2;
  const double discriminant = b * b - 4 * a;
  if (discriminant < 0) return std::nullopt;
  // The smallest positive one of the roots -2 / (b -+ sqrt(b^2 - 4 a)).
  const double root = std::sqrt(discriminant);
  const double low = -2 / (b - root), high = -2 / (b + root);
  const double least = std::min(low > 0 ? low : high, high > 0 ? high : low);
  if (!(least > 0) || !std::isfinite(least)) return std::nullopt;
  return std::sqrt(least);
}

/// The largest distance from the axis of a point, in any channel's image, inside the support of a pixel's
/// filter.
double film_reach(const CameraSettings& camera, const Film& film) {
  const HalfFilm size = half_film(camera, film);
  const double beyond = std::max(0.0, double(film.filter_radius) - 0.5);
  const auto farthest = [&](double low, double high, double whole, double offset, double half) {
    const auto at = [&](double pixel) { return std::abs(1 - 2 * pixel / whole - 2 * offset) * half; };
    return std::max(at(low - beyond), at(high + beyond));
  };
  const double x = farthest(film.crop_x, film.crop_x + film.crop_width, film.width,
                            camera.principal_point_offset_x, size.x);
  const double y = farthest(film.crop_y, film.crop_y + film.crop_height, film.height,
                            camera.principal_point_offset_y, size.y);
  const glm::dvec3 magnify = camera.magnify();
  return std::hypot(x, y) / (1 + std::min({magnify.x, magnify.y, magnify.z}));
}

}  // namespace

HalfFilm half_film(const CameraSettings& camera, const Film& film) {
  if (is_panorama(camera.projection)) return {1.0, 1.0};
  const double w = film.width, h = film.height;
  if (camera.projection == Projection::kOrthographic) return {camera.scale_x, camera.scale_y * h / w};
  const double high = h * camera.pixel_aspect, x = half_width_tangent(camera.fov, camera.fov_axis, w, high);
  return {x, x * high / w};
}

double distortion_reach(const CameraSettings& camera, const Film& film) {
  if (const auto most = fold(camera)) return *most;
  const double wanted = film_reach(camera, film);
  double reach = wanted;
  while (distorted(camera, reach) < wanted) reach *= 2;
  return reach;
}

Expected<void> check_camera(const CameraSettings& camera, const Film& film) {
  if (!(camera.near_clip < camera.far_clip)) {
    return fail(fmt::format("the camera's near_clip, {}, must be less than its far_clip, {}",
                            camera.near_clip, camera.far_clip));
  }
  if (camera.blades == 1 || camera.blades == 2)
    return fail(fmt::format("a lens has no {} blades: 3 or more, or 0 for a disk", camera.blades));
  if (camera.stereo != StereoPair::kNone && camera.projection != Projection::kEquirectangular)
    return fail("a stereo pair needs the projection equirectangular");
  if (is_panorama(camera.projection)) return check_panorama(camera, film);
  if (!camera.is_distorted()) return {};
  if (camera.projection != Projection::kPerspective)
    return fail("an orthographic image has no angles that distortion_k1 and distortion_k2 could distort");
  const auto most = fold(camera);
  const double reach = film_reach(camera, film);
  if (most && !(distorted(camera, *most) > reach)) {
    return fail(fmt::format(
        "the camera's distortion, r (1 + k1 r^2 + k2 r^4) with distortion_k1 = {} and distortion_k2 = {}, "
        "folds the image over: it grows up to r = {:.6g}, where it is {:.6g}, and the film reaches to {:.6g} "
        "(tangents of the angles off the axis)",
        camera.distortion_k1, camera.distortion_k2, *most, distorted(camera, *most), reach));
  }
  return {};
}

}  // namespace penumbra
