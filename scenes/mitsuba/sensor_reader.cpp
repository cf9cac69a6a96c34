#include "scenes/mitsuba/sensor_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "scenes/number.h"
#include "scenes/settings.h"
#include "scenes/transform.h"

namespace penumbra::mitsuba {
namespace {

using Names = std::vector<std::string>;

void choose(const PluginReader& plugin, SceneDescription& scene, std::string_view key,
            std::string_view value) {
  if (const auto done = apply_setting(scene, key, value); !done) plugin.wrong(done.error().message);
}

/// The full angle along the diagonal of a 35 mm film, 36 mm by 24 mm, for "50mm" (or "50").
void read_focal_length(PluginReader& plugin, SceneDescription& scene) {
  const std::string text = plugin.text("focal_length", "50mm");
  std::string_view digits = trim(text);
  if (digits.ends_with("mm")) digits.remove_suffix(2);
  const auto millimetres = parse_number(digits);
  if (!millimetres || !(*millimetres > 0.0)) {
    plugin.wrong("focal_length", fmt::format("'{}' is not a focal length such as 50mm", text));
    return;
  }
  constexpr double kFilmDiagonal = 43.266615305567875;  // mm
  scene.camera.fov = 2.0 * std::atan(0.5 * kFilmDiagonal / *millimetres) * 180.0 / std::numbers::pi;
  scene.camera.fov_axis = FovAxis::kDiagonal;
}

void read_view_angle(PluginReader& plugin, SceneDescription& scene) {
  if (plugin.has("fov")) {
    if (plugin.has("focal_length")) plugin.wrong("focal_length", "either fov or focal_length, not both");
    plugin.accept({"focal_length"});
    plugin.settings(scene, "camera", Names{"fov", "fov_axis"});
    return;
  }
  read_focal_length(plugin, scene);
  if (plugin.has("fov_axis"))
    plugin.wrong("fov_axis", "fov_axis needs a fov; a focal length is of the diagonal");
  plugin.accept({"fov", "fov_axis"});
}

void read_camera(PluginReader& plugin, SceneDescription& scene) {
  read_view_angle(plugin, scene);
  plugin.settings(scene, "camera", Names{"near_clip", "far_clip"});
  const auto frame = without_scale(plugin.transform("to_world"));
  if (frame) {
    scene.camera.to_world = *frame;
  } else {
    plugin.wrong("to_world", frame.error().message);
  }
  for (const char* name : {"principal_point_offset_x", "principal_point_offset_y"}) {
    if (plugin.number(name, 0.0) != 0.0) plugin.wrong(name, fmt::format("{} other than 0 is not read", name));
  }
  // Depth of field and motion blur are those of other cameras.
  plugin.accept({"focus_distance", "shutter_open", "shutter_close"});
}

void read_filter(const Context& context, const Object& object, SceneDescription& scene) {
  static const std::map<std::string, Names, std::less<>> kFilters = {
      {"box", {}}, {"tent", {"radius"}}, {"gaussian", {"stddev"}}, {"mitchell", {"b", "c"}}};
  PluginReader plugin(context, object);
  const auto filter = kFilters.find(object.type);
  if (filter == kFilters.end()) {
    context.unknown_plugin(object, Names{"box", "tent", "gaussian", "mitchell"},
                           "a gaussian stands in for it");
    return;
  }
  choose(plugin, scene, "film.rfilter", object.type);
  plugin.settings(scene, "film", filter->second, "rfilter_");
  plugin.finish();
}

void read_film(const Context& context, const Object& object, SceneDescription& scene) {
  PluginReader plugin(context, object);
  plugin.settings(scene, "film",
                  Names{"width", "height", "crop_offset_x", "crop_offset_y", "crop_width", "crop_height"});
  const Object* filter = plugin.only_nested("rfilter");
  if (object.type == "hdrfilm" || object.type == "ldrfilm") {
    // How Mitsuba writes its files; Penumbra's options are its command line's.
    plugin.accept({"pixel_format", "component_format", "file_format", "gamma", "banner", "attach_log",
                   "high_quality_edges", "exposure", "tonemap_method", "key", "burn", "sample_border",
                   "compensate"});
  } else {
    context.unknown_plugin(object, Names{"hdrfilm", "ldrfilm"}, "an hdrfilm stands in for it");
    plugin.skip();
  }
  plugin.finish();
  if (filter != nullptr) read_filter(context, *filter, scene);
}

void read_sampler(const Context& context, const Object& object, SceneDescription& scene) {
  /// Mitsuba's samplers, and what comes nearest to each.
  static const std::map<std::string, std::string, std::less<>> kSamplers = {
      {"independent", "independent"}, {"stratified", "stratified"},
      {"multijitter", "stratified"},  {"halton", "halton"},
      {"hammersley", "halton"},       {"ldsampler", "sobol"},
      {"orthogonal", "sobol"},        {"sobol", "sobol"}};
  PluginReader plugin(context, object);
  plugin.settings(scene, "sampler", Names{"sample_count", "seed"});
  const auto sampler = kSamplers.find(object.type);
  if (sampler != kSamplers.end()) {
    choose(plugin, scene, "sampler.type", sampler->second);
    plugin.accept({"jitter", "scramble", "dimension"});
  } else {
    Names known;
    for (const auto& [name, kind] : kSamplers) known.push_back(name);
    context.unknown_plugin(object, known, "sobol stands in for it");
    plugin.skip();
  }
  plugin.finish();
}

/// The integrator itself, out of those that only add outputs to it.
const Object* unwrap(const Context& context, const Object& object) {
  const Object* inner = &object;
  for (int depth = 0; inner != nullptr && (inner->type == "moment" || inner->type == "aov"); ++depth) {
    PluginReader plugin(context, *inner);
    const Object* next = plugin.only_nested("integrator");
    plugin.accept({"aovs"});
    plugin.finish();
    if (next == nullptr || depth > 16)
      plugin.wrong(fmt::format("{} needs an <integrator> to work on", plugin.title()));
    inner = depth > 16 ? nullptr : next;
  }
  return inner;
}

}  // namespace

void read_sensor(const Context& context, const Object& object, SceneDescription& scene) {
  PluginReader plugin(context, object);
  read_camera(plugin, scene);
  const Object* film = plugin.only_nested("film");
  const Object* sampler = plugin.only_nested("sampler");
  for (const Object* medium : plugin.nested("medium")) context.unknown_plugin(*medium, {}, "it is left out");
  if (object.type != "perspective") {
    context.unknown_plugin(object, Names{"perspective"}, "a perspective one stands in for it");
    plugin.skip();
  }
  plugin.finish();
  if (film != nullptr) read_film(context, *film, scene);
  if (sampler != nullptr) read_sampler(context, *sampler, scene);
}

void read_integrator(const Context& context, const Object& object, SceneDescription& scene) {
  static const Names kPath = {"max_depth",     "rr_depth",        "emitter_sampling", "mis",
                              "hide_emitters", "hidden_emitters", "light_choice",     "nee",
                              "alpha",         "estimator"};
  static const std::map<std::string, Names, std::less<>> kIntegrators = {
      {"direct",
       {"shading_samples", "emitter_samples", "bsdf_samples", "bsdf_sampling", "emitter_sampling", "mis",
        "hide_emitters", "hidden_emitters", "light_choice", "trace_shadows"}},
      {"path",
       {"max_depth", "rr_depth", "direct_sampling", "emitter_sampling", "mis", "hide_emitters",
        "hidden_emitters", "light_choice", "nee", "alpha", "estimator"}},
      {"polygon_analytic", {"hide_emitters", "hidden_emitters"}},
      {"polygon_area",
       {"emitter_samples", "emitter_sampling", "light_choice", "trace_shadows", "hide_emitters",
        "hidden_emitters"}},
      {"polygon_cv",
       {"alpha", "vis_samples", "estimator", "emitter_sampling", "light_choice", "hide_emitters",
        "hidden_emitters"}},
      {"path_mats", kPath},
      {"path_ems", kPath},
      {"path_mis", kPath}};
  const Object* inner = unwrap(context, object);
  if (inner == nullptr) return;
  PluginReader plugin(context, *inner);
  const auto known = kIntegrators.find(inner->type);
  if (known == kIntegrators.end()) {
    Names names = {"moment", "aov"};
    for (const auto& [name, parameters] : kIntegrators) names.push_back(name);
    context.unknown_plugin(*inner, names, "path stands in for it");
    plugin.settings(scene, "integrator", Names{"max_depth", "rr_depth", "hide_emitters", "hidden_emitters"});
    return;
  }
  choose(plugin, scene, "integrator.type", inner->type);
  plugin.settings(scene, "integrator", known->second);
  // How Mitsuba divides its work, and a rule about shading normals that its version 3 has dropped.
  plugin.accept({"strict_normals", "samples_per_pass", "block_size", "timeout"});
  plugin.finish();
}

}  // namespace penumbra::mitsuba
