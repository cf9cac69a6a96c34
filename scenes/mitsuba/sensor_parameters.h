// The plugins of the camera's side: which settings they read under their own names, for the reader and for
// the reference of all plugins.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace penumbra::mitsuba {

using SettingNames = std::vector<std::string>;

// Of `camera`: the view angle, what every sensor has, a lens, a distortion.
inline const SettingNames kViewAngle = {"fov", "fov_axis"};
inline const SettingNames kPlace = {
    "near_clip",     "far_clip",    "principal_point_offset_x", "principal_point_offset_y", "magnify_red",
    "magnify_green", "magnify_blue"};
inline const SettingNames kLens = {"aperture_radius", "focus_distance", "blades",      "blade_rotation",
                                   "refocus_red",     "refocus_green",  "refocus_blue"};
inline const SettingNames kDistortion = {"distortion_k1", "distortion_k2"};

/// Of `film`: its size.
inline const SettingNames kFilmSize = {"width",         "height",     "crop_offset_x",
                                       "crop_offset_y", "crop_width", "crop_height"};
struct FilmPlugin {
  std::string_view type;
};
/// Alike here. That of spectral bands (specfilm) has no image in red, green and blue.
constexpr FilmPlugin kFilms[] = {{"hdrfilm"}, {"ldrfilm"}, {"mfilm"}, {"tiledhdrfilm"}};

/// Of `film`, with `rfilter_` before the names.
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

/// Of `sampler`.
inline const SettingNames kSamplerSettings = {"sample_count", "seed"};
/// Mitsuba's, and what comes nearest to each.
struct SamplerPlugin {
  std::string_view type, nearest;
};
constexpr SamplerPlugin kSamplers[] = {
    // Orthogonal arrays of versions before 3.
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
