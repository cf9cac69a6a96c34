// The camera, with one table row for every parameter that is a number or a choice. A new parameter needs a
// member here and a row below. --set, scene files, messages, the table of all settings and the copy to the
// kernels are all generated from the row.
#pragma once

#include <glm/glm.hpp>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "kernels/host/error.h"
#include "kernels/scene_types.h"
#include "scenes/setting_values.h"

namespace penumbra {

enum class Projection {
  kPerspective,
  kOrthographic,
  kEquirectangular,
  kCylindrical,
  kFisheyeEquidistant,
  kFisheyeEquisolid,
  kEqualArea
};
/// Pictures of two eyes: none; the left eye's above the right eye's.
enum class StereoPair { kNone, kTopBottom };
enum class FovAxis { kX, kY, kDiagonal, kSmaller, kLarger };

enum class ShutterPosition { kStart, kCenter, kEnd };
constexpr std::size_t kMostShutterKnots = 256;
inline const std::vector<double> kBoxShutter{1.0, 1.0}, kTriangleShutter{0.0, 1.0, 0.0};

inline OneOf<FovAxis> fov_axes() {
  return {{{"x", FovAxis::kX},
           {"y", FovAxis::kY},
           {"diagonal", FovAxis::kDiagonal},
           {"smaller", FovAxis::kSmaller},
           {"larger", FovAxis::kLarger}}};
}

inline OneOf<Projection> projections() {
  return {{{"perspective", Projection::kPerspective},
           {"orthographic", Projection::kOrthographic},
           {"equirectangular", Projection::kEquirectangular},
           {"cylindrical", Projection::kCylindrical},
           {"fisheye_equidistant", Projection::kFisheyeEquidistant},
           {"fisheye_equisolid", Projection::kFisheyeEquisolid},
           {"equal_area", Projection::kEqualArea}}};
}
inline std::string projection_name(Projection projection) { return projections().print(projection); }

/// Camera space looks along +z, with +y up and +x to the left of the image (Mitsuba's convention). Every
/// camera may have a lens, and planes of focus that differ between colour channels. Only a perspective camera
/// may have distortion, and panoramas have images of one size in all channels. A panorama's lens is a disk
/// perpendicular to each ray, and what is a distance along z for other cameras is a distance along the ray.
struct CameraSettings {
  Projection projection = Projection::kPerspective;
  /// Camera to world; the axes are orthogonal and may be mirrored; their lengths have no effect.
  glm::dmat4 to_world{1.0};
  /// Full angle of view in degrees, in (0, 180), along `fov_axis`, of the whole film (not of the crop
  /// window).
  double fov = 50.0;
  FovAxis fov_axis = FovAxis::kX;
  /// Height of a pixel over its width; perspective. The angle of view is that of a film of such pixels.
  double pixel_aspect = 1.0;
  /// Orthographic camera: half the film's width, and half its height times its aspect ratio.
  double scale_x = 1.0, scale_y = 1.0;
  /// Panoramas. Degrees to the right of +z and above the horizon, at the film's edges; equirectangular, and
  /// longitudes of cylindrical ones.
  double longitude_min = -180.0, longitude_max = 180.0;
  double latitude_min = -90.0, latitude_max = 90.0;
  /// Cylindrical: heights at the film's lower and upper edge on a cylinder of radius 1 about the camera.
  double height_min = -1.0, height_max = 1.0;
  /// Fisheyes: full angle of view of their circle, in degrees, at most 360. Beyond it the image is black with
  /// alpha 0. An equidistant one's circle touches the film's edges along `fov_axis`.
  double fisheye_fov = 180.0;
  /// Equisolid fisheye: a direction at an angle off the axis is at distance 2 fisheye_lens sin(angle / 2)
  /// from the centre of a film as wide as sensor_width; both in millimetres.
  double fisheye_lens = 10.5, sensor_width = 36.0;
  /// Equirectangular: two pictures of eyes at that distance from each other, in scene units.
  StereoPair stereo = StereoPair::kNone;
  double interocular_distance = 0.065;
  /// Distances along +z; the camera sees nothing nearer than near_clip or farther than far_clip.
  double near_clip = 1e-2;
  double far_clip = 1e4;
  /// Shift of the film to the right and down, as fractions of its width and height.
  double principal_point_offset_x = 0.0, principal_point_offset_y = 0.0;
  double aperture_radius = 0.0;  ///< scene units; 0: a pinhole
  double focus_distance = 1e4;   ///< distance along +z of the plane in focus
  int blades = 0;                ///< corners of the aperture, on its circle; 0: a disk
  /// Degrees, from camera space's x axis towards its y axis, to the first corner.
  double blade_rotation = 0.0;
  /// Radial distortion: a point that a pinhole camera shows at distance r from the axis appears at r (1 + k1
  /// r^2 + k2 r^4). Both distances are tangents of angles.
  double distortion_k1 = 0.0, distortion_k2 = 0.0;
  /// Chromatic aberration: the relative amount by which a channel's image is larger than the film's, and by
  /// which its plane of focus is farther away.
  double magnify_red = 0.0, magnify_green = 0.0, magnify_blue = 0.0;
  double refocus_red = 0.0, refocus_green = 0.0, refocus_blue = 0.0;

  /// The shutter, see motion/exposure.h. Shares of the frame's duration.
  std::optional<float> shutter;  ///< for which each row is exposed; nothing: what the file says
  /// Where the frame's time is in the whole time that the shutter is open.
  ShutterPosition shutter_position = ShutterPosition::kStart;
  /// How far it is open at evenly spaced times; linear between them.
  std::vector<double> shutter_curve = kBoxShutter;
  double rolling_shutter = 0.0;  ///< by which the last row of the film starts later than the first

  [[nodiscard]] glm::dvec3 magnify() const { return {magnify_red, magnify_green, magnify_blue}; }
  [[nodiscard]] glm::dvec3 refocus() const { return {refocus_red, refocus_green, refocus_blue}; }
  [[nodiscard]] bool is_distorted() const { return distortion_k1 != 0.0 || distortion_k2 != 0.0; }
};

/// Calls row(name, member, values, text[, member of the kernels' camera that it is copied to]) for each
/// parameter.
template <typename Row>
void camera_parameters(const Row& row) {
  using C = CameraSettings;
  constexpr double kFar = std::numeric_limits<float>::max();
  constexpr Number<double> kLength{LowEnd::kOpen, 0.0, kFar};
  constexpr Number<double> kShare{LowEnd::kOpen, -1.0, 1.0};
  row("projection", &C::projection, projections(), "perspective, parallel or panoramic projection");
  row("fov", &C::fov, Number<double>{LowEnd::kOpen, 0.0, 180.0},
      "full angle of view of the whole film, degrees; perspective");
  row("fov_axis", &C::fov_axis, fov_axes(),
      "axis of the film that fov, or an equidistant fisheye_fov, spans");
  row("pixel_aspect", &C::pixel_aspect, kLength, "height of a pixel over its width; perspective");
  row("scale_x", &C::scale_x, kLength, "half the width of the view; orthographic");
  row("scale_y", &C::scale_y, kLength, "half the height of the view of a square film; orthographic");
  constexpr Number<double> kAngle{LowEnd::kClosed, -720.0, 720.0};
  constexpr Number<double> kHeight{LowEnd::kClosed, -1e6, 1e6};
  row("longitude_min", &C::longitude_min, kAngle,
      "degrees to the right of the view at the film's left edge; equirectangular, cylindrical");
  row("longitude_max", &C::longitude_max, kAngle, "... at its right edge, at most 360 more");
  row("latitude_min", &C::latitude_min, kAngle,
      "degrees above the horizon at the film's lower edge, from -90; equirectangular");
  row("latitude_max", &C::latitude_max, kAngle, "... at its upper edge, up to 90");
  row("height_min", &C::height_min, kHeight,
      "height at the film's lower edge, on a cylinder of radius 1; cylindrical");
  row("height_max", &C::height_max, kHeight, "... at its upper edge");
  row("fisheye_fov", &C::fisheye_fov, Number<double>{LowEnd::kOpen, 0.0, 720.0},
      "full angle of view of a fisheye's circle, degrees, up to 360; beyond it the image is black");
  row("fisheye_lens", &C::fisheye_lens, kLength, "focal length in mm; fisheye_equisolid");
  row("sensor_width", &C::sensor_width, kLength, "width of the film in mm; fisheye_equisolid");
  row("stereo", &C::stereo,
      OneOf<StereoPair>{{{"none", StereoPair::kNone}, {"top_bottom", StereoPair::kTopBottom}}},
      "pictures of two eyes (omni-directional stereo), the left one's above; equirectangular");
  row("interocular_distance", &C::interocular_distance, Number<double>{LowEnd::kClosed, 0.0, kFar},
      "distance of the eyes of a stereo pair");
  row("near_clip", &C::near_clip, kLength, "nearest distance along the view that is seen",
      &Camera::near_clip);
  row("far_clip", &C::far_clip, kLength, "farthest distance along the view that is seen", &Camera::far_clip);
  row("principal_point_offset_x", &C::principal_point_offset_x, Number<double>{LowEnd::kClosed, -1e3, 1e3},
      "horizontal offset of the principal point from the film's centre, in film widths, as Mitsuba's");
  row("principal_point_offset_y", &C::principal_point_offset_y, Number<double>{LowEnd::kClosed, -1e3, 1e3},
      "vertical offset of the principal point from the film's centre, in film heights");
  row("aperture_radius", &C::aperture_radius, Number<double>{LowEnd::kClosed, 0.0, kFar},
      "radius of the lens; 0: a pinhole", &Camera::lens_radius);
  row("focus_distance", &C::focus_distance, kLength, "distance along the view that is in focus");
  row("blades", &C::blades, WholeNumber{0, 64}, "corners of the lens, which lie on its circle; 0: a disk",
      &Camera::blades);
  row("blade_rotation", &C::blade_rotation, Number<double>{LowEnd::kClosed, -3600.0, 3600.0},
      "rotation of the first corner, degrees from the left of the picture upwards");
  row("distortion_k1", &C::distortion_k1, Number<double>{LowEnd::kClosed, -1e6, 1e6},
      "radial distortion k1; r becomes r (1 + k1 r^2 + k2 r^4), in tangents of angles from the axis; below "
      "0: a barrel",
      &Camera::k1);
  row("distortion_k2", &C::distortion_k2, Number<double>{LowEnd::kClosed, -1e6, 1e6}, "radial distortion k2",
      &Camera::k2);
  row("magnify_red", &C::magnify_red, kShare,
      "lateral chromatic aberration; share by which the red image is larger");
  row("magnify_green", &C::magnify_green, kShare,
      "lateral chromatic aberration; share by which the green image is larger");
  row("magnify_blue", &C::magnify_blue, kShare,
      "lateral chromatic aberration; share by which the blue image is larger");
  row("refocus_red", &C::refocus_red, kShare,
      "axial chromatic aberration; share by which the focus of red is farther");
  row("refocus_green", &C::refocus_green, kShare,
      "axial chromatic aberration; share by which the focus of green is farther");
  row("refocus_blue", &C::refocus_blue, kShare,
      "axial chromatic aberration; share by which the focus of blue is farther");
  row("shutter", &C::shutter, NumberOrAuto{0.0f, 10.0f},
      "share of the frame's duration, 1 / fps, for which the shutter is open; 0: never, an image of one "
      "instant; auto: the time that the scene file says");
  row("shutter_position", &C::shutter_position,
      OneOf<ShutterPosition>{{{"start", ShutterPosition::kStart},
                              {"center", ShutterPosition::kCenter},
                              {"centre", ShutterPosition::kCenter},
                              {"end", ShutterPosition::kEnd}}},
      "where the frame's time is in that of the shutter");
  row("shutter_curve", &C::shutter_curve,
      NamedCurve{{{"box", kBoxShutter}, {"triangle", kTriangleShutter}}, kMostShutterKnots},
      "how far the shutter is open, at evenly spaced times and linear between them");
  row("rolling_shutter", &C::rolling_shutter, Number<double>{LowEnd::kClosed, 0.0, 10.0},
      "share of the frame's duration by which the film's last row starts later than the first");
}

struct Film;

/// Half the width and height of what the film sees: at distance 1 for a perspective camera, in scene units
/// for an orthographic one, 1 for a panorama.
struct HalfFilm {
  double x, y;
};
HalfFilm half_film(const CameraSettings& camera, const Film& film);

/// An upper bound of the undistorted radius r whose distorted image lies on the film. The camera must have
/// passed check_camera.
double distortion_reach(const CameraSettings& camera, const Film& film);

/// Checks that involve several parameters. Errors: near_clip is not below far_clip; an aperture of one or two
/// corners; distortion of an orthographic camera; a distortion that does not increase monotonically up to the
/// corners of the film (the message says up to which radius it does); those of check_panorama; a stereo pair
/// of another camera.
Expected<void> check_camera(const CameraSettings& camera, const Film& film);

}  // namespace penumbra
