#include "scenes/panoramas.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "scenes/angles.h"
#include "scenes/scene_description.h"
#include "scenes/view_angle.h"

namespace penumbra {
namespace {

constexpr double kTurn = 360.0;  // degrees

int kind_of(Projection projection) {
  switch (projection) {
    case Projection::kEquirectangular:
      return PANORAMA_EQUIRECTANGULAR;
    case Projection::kCylindrical:
      return PANORAMA_CYLINDRICAL;
    case Projection::kFisheyeEquidistant:
      return PANORAMA_EQUIDISTANT;
    case Projection::kFisheyeEquisolid:
      return PANORAMA_EQUISOLID;
    case Projection::kEqualArea:
      return PANORAMA_EQUAL_AREA;
    default:
      return PANORAMA_NONE;
  }
}

double middle(double low, double high) { return 0.5 * (low + high); }
double half(double low, double high) { return 0.5 * (high - low); }

}  // namespace

bool is_panorama(Projection projection) { return kind_of(projection) != PANORAMA_NONE; }

bool is_fisheye(Projection projection) {
  return projection == Projection::kFisheyeEquidistant || projection == Projection::kFisheyeEquisolid;
}

PanoramaFilm panorama_film(const CameraSettings& c, const Film& film) {
  const double w = film.width, h = film.height;
  PanoramaFilm result{.kind = kind_of(c.projection)};
  switch (c.projection) {
    case Projection::kEquirectangular:
    case Projection::kCylindrical: {
      // Longitudes grow to the right, the kernels' coordinates to the left.
      result.center.x = -middle(c.longitude_min, c.longitude_max) / kTurn;
      result.half.x = half(c.longitude_min, c.longitude_max) / kTurn;
      const bool flat = c.projection == Projection::kEquirectangular;
      result.center.y =
          flat ? middle(c.latitude_min, c.latitude_max) / kTurn : middle(c.height_min, c.height_max);
      result.half.y = flat ? half(c.latitude_min, c.latitude_max) / kTurn : half(c.height_min, c.height_max);
      break;
    }
    case Projection::kFisheyeEquidistant:
      result.limit = 0.5 * c.fisheye_fov / kTurn;
      result.half = result.limit / axis_length(c.fov_axis, w, h) * glm::dvec2(w, h);
      break;
    case Projection::kFisheyeEquisolid:
      result.limit = std::sin(0.25 * c.fisheye_fov * kDegree);
      // r = 2 f sin(angle / 2), of which the film shows half its width.
      result.half = 0.25 * c.sensor_width / c.fisheye_lens * glm::dvec2(1.0, h / w);
      break;
    default:
      break;
  }
  return result;
}

double pixels_per_radian(const CameraSettings& camera, const Film& film) {
  const PanoramaFilm seen = panorama_film(camera, film);
  const double height = camera.stereo == StereoPair::kNone ? film.height : film.height / 2;
  const glm::dvec2 pixels(0.5 * film.width / seen.half.x, 0.5 * height / seen.half.y);
  constexpr double kTurnsPerRadian = 1 / (2 * kPi);
  switch (camera.projection) {
    case Projection::kCylindrical: {
      const double highest = std::max(std::abs(camera.height_min), std::abs(camera.height_max));
      return std::max(pixels.x * kTurnsPerRadian, pixels.y * (1 + highest * highest));
    }
    // The derivative of sin(angle / 2).
    case Projection::kFisheyeEquisolid:
      return 0.5 * std::max(pixels.x, pixels.y);
    // Sampled in a million points: up to 0.974 half widths a radian, in every direction.
    case Projection::kEqualArea:
      return std::max(pixels.x, pixels.y);
    default:
      return kTurnsPerRadian * std::max(pixels.x, pixels.y);
  }
}

Expected<void> check_panorama(const CameraSettings& c, const Film& film) {
  const bool turns = c.projection == Projection::kEquirectangular || c.projection == Projection::kCylindrical;
  if (turns && !(c.longitude_min < c.longitude_max && c.longitude_max - c.longitude_min <= kTurn))
    return fail(fmt::format(
        "the camera's longitude_min, {}, must be less than its longitude_max, {}, by at most 360 degrees",
        c.longitude_min, c.longitude_max));
  if (c.projection == Projection::kEquirectangular &&
      !(c.latitude_min < c.latitude_max && c.latitude_min >= -90.0 && c.latitude_max <= 90.0))
    return fail(fmt::format(
        "the camera's latitudes must be latitude_min < latitude_max from -90 to 90 degrees, not {} and {}",
        c.latitude_min, c.latitude_max));
  if (c.projection == Projection::kCylindrical && !(c.height_min < c.height_max))
    return fail(fmt::format("the camera's height_min, {}, must be less than its height_max, {}", c.height_min,
                            c.height_max));
  if (is_fisheye(c.projection) && !(c.fisheye_fov <= kTurn))
    return fail(fmt::format("the camera's fisheye_fov must be at most 360 degrees, not {}", c.fisheye_fov));
  if (c.is_distorted()) return fail("a panorama has no distortion_k1 and distortion_k2");
  if (c.magnify() != glm::dvec3(0.0))
    return fail("a panorama has no magnify_red, magnify_green and magnify_blue");
  if (!is_fisheye(c.projection) && (c.principal_point_offset_x != 0.0 || c.principal_point_offset_y != 0.0))
    return fail(
        "of panoramas only fisheyes have a principal_point_offset_x and principal_point_offset_y; the ranges "
        "of others say what the film shows");
  if (c.stereo == StereoPair::kNone) return {};
  if (film.height % 2 != 0)
    return fail(fmt::format("a film of two pictures must have an even height, not {}", film.height));
  return {};
}

}  // namespace penumbra
