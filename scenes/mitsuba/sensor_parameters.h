// The plugins of sensors, films, filters and samplers, and the settings that each reads under its own names.
// The reader and the plugin reference use these tables.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "scenes/cameras.h"

namespace penumbra::mitsuba {

using SettingNames = std::vector<std::string>;

// Settings of `camera`: the angle of view, those of every sensor, a lens, a distortion.
inline const SettingNames kViewAngle = {"fov", "fov_axis"};
inline const SettingNames kPlace = {"near_clip",
                                    "far_clip",
                                    "principal_point_offset_x",
                                    "principal_point_offset_y",
                                    "pixel_aspect",
                                    "magnify_red",
                                    "magnify_green",
                                    "magnify_blue",
                                    "shutter",
                                    "shutter_position",
                                    "shutter_curve",
                                    "rolling_shutter"};
inline const SettingNames kLens = {"aperture_radius", "focus_distance", "blades",      "blade_rotation",
                                   "refocus_red",     "refocus_green",  "refocus_blue"};
/// Panoramas: sensors of our own, named as their projections. They also read kPlace and kLens.
struct PanoramaPlugin {
  const char* type;
  Projection projection;
  SettingNames parameters;
  const char* text;
};
inline const std::vector<PanoramaPlugin> kPanoramas = {
    {"equirectangular",
     Projection::kEquirectangular,
     {"longitude_min", "longitude_max", "latitude_min", "latitude_max", "stereo", "interocular_distance"},
     "panorama of longitudes and latitudes"},
    {"cylindrical",
     Projection::kCylindrical,
     {"longitude_min", "longitude_max", "height_min", "height_max"},
     "panorama on a cylinder"},
    {"fisheye_equidistant",
     Projection::kFisheyeEquidistant,
     {"fisheye_fov", "fov_axis"},
     "fisheye whose radius is the angle off the axis"},
    {"fisheye_equisolid",
     Projection::kFisheyeEquisolid,
     {"fisheye_fov", "fisheye_lens", "sensor_width"},
     "fisheye whose area is the solid angle"},
    {"equal_area", Projection::kEqualArea, {}, "all directions on a square of equal areas (Clarberg 2008)"}};

inline const SettingNames kDistortion = {"distortion_k1", "distortion_k2"};

/// Settings of `film`: its size.
inline const SettingNames kFilmSize = {"width",         "height",     "crop_offset_x",
                                       "crop_offset_y", "crop_width", "crop_height"};
struct FilmPlugin {
  std::string_view type;
};
/// These films are treated alike. The film of spectral bands (specfilm) is not supported, since it has no RGB
/// image.
constexpr FilmPlugin kFilms[] = {{"hdrfilm"}, {"ldrfilm"}, {"mfilm"}, {"tiledhdrfilm"}};

/// Settings of `film`; in their keys the names begin with `rfilter_`.
struct FilterPlugin {
  std::string_view type;
  const char* ours;
  SettingNames parameters;
  std::string_view text;
};
inline const std::vector<FilterPlugin> kFilters = {
    {"box", "box", {"radius"}, "constant over a pixel"},
    {"tent", "tent", {"radius"}, "linear to 0 at the radius"},
    {"gaussian", "gaussian", {"stddev"}, "Gaussian"},
    {"mitchell", "mitchell", {"b", "c"}, "Mitchell and Netravali"},
    {"catmullrom", "mitchell", {}, "Catmull and Rom: mitchell with b = 0, c = 1/2"},
    {"lanczos", "lanczos", {}, "Lanczos-windowed sinc"}};
constexpr std::int64_t kFilterLobes = 3, kMostFilterLobes = 64;

/// Settings of `sampler`.
inline const SettingNames kSamplerSettings = {"sample_count", "seed"};
/// A sampler of Mitsuba and the most similar one here.
struct SamplerPlugin {
  std::string_view type, nearest;
};
constexpr SamplerPlugin kSamplers[] = {
    // Samplers with orthogonal arrays, from versions before 3.
    {"bose", "sobol"},
    {"bush", "sobol"},
    {"halton", "halton"},
    {"hammersley", "halton"},
    {"independent", "independent"},
    {"ldsampler", "sobol"},
    {"multijitter", "stratified"},
    {"orthogonal", "sobol"},
    {"sobol", "sobol"},
    {"stratified", "stratified"}};

}  // namespace penumbra::mitsuba
