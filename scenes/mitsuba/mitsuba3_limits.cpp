#include "scenes/mitsuba/mitsuba3_limits.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace penumbra::mitsuba {
namespace {

// Found by loading each plugin and parameter that scene_writer.cpp may write with Mitsuba 3.9.1.
constexpr std::pair<std::string_view, std::string_view> kPlugins[] = {{"bsdf", "blinnphong"},
                                                                      {"bsdf", "difftrans"},
                                                                      {"bsdf", "disney"},
                                                                      {"bsdf", "microfacet"},
                                                                      {"bsdf", "openpbr"},
                                                                      {"bsdf", "phong"},
                                                                      {"bsdf", "roughdiffuse"},
                                                                      {"bsdf", "turnedtangent"},
                                                                      {"bsdf", "ward"},
                                                                      {"emitter", "sky"},
                                                                      {"emitter", "sun"},
                                                                      {"integrator", "ao"},
                                                                      {"integrator", "normals"},
                                                                      {"integrator", "photonmapper"},
                                                                      {"integrator", "polygon_area"},
                                                                      {"integrator", "polygon_analytic"},
                                                                      {"integrator", "polygon_cv"},
                                                                      {"integrator", "ppm"},
                                                                      {"integrator", "ro"},
                                                                      {"integrator", "whitted"},
                                                                      {"sampler", "halton"},
                                                                      {"sensor", "cylindrical"},
                                                                      {"sensor", "equal_area"},
                                                                      {"sensor", "equirectangular"},
                                                                      {"sensor", "fisheye_equidistant"},
                                                                      {"sensor", "fisheye_equisolid"},
                                                                      {"sensor", "telecentric"},
                                                                      {"texture", "noise"},
                                                                      {"texture", "scale"}};

struct PluginParameterName {
  std::string_view type, name;
};
constexpr PluginParameterName kParameters[] = {{"area", "sampling"},
                                               {"area", "seen_by_camera"},
                                               {"area", "spread"},
                                               {"area", "two_sided"},
                                               {"bitmap", "channel"},
                                               {"bitmap", "gamma"},
                                               {"bitmap", "wrap_mode_u"},
                                               {"bitmap", "wrap_mode_v"},
                                               {"bsplinecurve", "form"},
                                               {"conductor", "ext_eta"},
                                               {"dielectric", "abbe"},
                                               {"direct", "hidden_emitters"},
                                               {"direct", "trace_shadows"},
                                               {"directional", "angle"},
                                               {"directional", "seen_by_camera"},
                                               {"hair", "offset"},
                                               {"hair", "reflectance"},
                                               {"mitchell", "b"},
                                               {"mitchell", "c"},
                                               {"path", "hidden_emitters"},
                                               {"path", "only_bounces"},
                                               {"path", "only_technique"},
                                               {"plastic", "optical_depth"},
                                               {"roughconductor", "ext_eta"},
                                               {"roughdielectric", "abbe"},
                                               {"roughplastic", "optical_depth"},
                                               {"spot", "falloff"},
                                               {"spot", "radius"},
                                               {"volpath", "hidden_emitters"}};
constexpr std::string_view kOfCameras[] = {
    "blades",        "blade_rotation", "distortion_k1",  "distortion_k2", "magnify_red",
    "magnify_green", "magnify_blue",   "refocus_red",    "refocus_green", "refocus_blue",
    "pixel_aspect",  "shutter_curve",  "rolling_shutter"};

}  // namespace

std::string why_mitsuba3_refuses(std::string_view tag, std::string_view type, std::string_view parameter) {
  const auto is_plugin = [&](const auto& each) { return each.first == tag && each.second == type; };
  if (std::ranges::any_of(kPlugins, is_plugin)) return fmt::format("Mitsuba 3 has no {} '{}'", tag, type);
  const auto is_parameter = [&](const auto& each) { return each.type == type && each.name == parameter; };
  const bool is_of_camera =
      tag == "sensor" && std::ranges::find(kOfCameras, parameter) != std::end(kOfCameras);
  if (is_of_camera || std::ranges::any_of(kParameters, is_parameter))
    return fmt::format("Mitsuba 3's {} '{}' has no '{}'", tag, type, parameter);
  return "";
}

}  // namespace penumbra::mitsuba
