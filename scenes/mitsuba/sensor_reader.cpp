#include "scenes/mitsuba/sensor_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "scenes/mitsuba/medium_reader.h"
#include "scenes/mitsuba/sensor_parameters.h"
#include "scenes/names.h"
#include "scenes/settings.h"
#include "scenes/transform.h"
#include "scenes/view_angle.h"

namespace penumbra::mitsuba {
namespace {

constexpr double kLongestShutter = 1e30;  // seconds

void choose(const PluginReader& plugin, SceneDescription& scene, std::string_view key,
            std::string_view value) {
  if (const auto done = apply_setting(scene, key, value); !done) plugin.wrong(done.error().message);
}

void read_focal_length(PluginReader& plugin, SceneDescription& scene) {
  const std::string text = plugin.text("focal_length", "50mm");
  const auto angle = angle_of_focal_length(text);
  if (!angle) {
    plugin.wrong("focal_length", fmt::format("'{}' is not a focal length such as 50mm", text));
    return;
  }
  scene.camera.fov = *angle;
  scene.camera.fov_axis = FovAxis::kDiagonal;
}

void read_view_angle(PluginReader& plugin, SceneDescription& scene) {
  if (plugin.has("fov")) {
    if (plugin.has("focal_length")) plugin.wrong("focal_length", "either fov or focal_length, not both");
    plugin.accept({"focal_length"});
    plugin.settings(scene, "camera", kViewAngle);
    return;
  }
  read_focal_length(plugin, scene);
  if (plugin.has("fov_axis"))
    plugin.wrong("fov_axis", "fov_axis needs a fov; a focal length is of the diagonal");
  plugin.accept({"fov", "fov_axis"});
}

/// Checks the shutter's times, which Animations takes.
void read_shutter(PluginReader& plugin) {
  const double open = plugin.number("shutter_open", 0.0), close = plugin.number("shutter_close", 0.0);
  if (plugin.has("shutter_close") && !(close >= open && close - open < kLongestShutter))
    plugin.wrong(
        "shutter_close",
        fmt::format("the shutter closes at {}; it opens at {}, and must not close before that or {} later",
                    close, open, kLongestShutter));
  if (plugin.has("rolling_shutter_type") || plugin.has("rolling_shutter_duration"))
    plugin.warn("all rows are exposed at the same time; rolling_shutter delays the last one");
  plugin.accept({"rolling_shutter_type", "rolling_shutter_duration"});
}

/// Reads what all cameras share: position, clipping planes, and effects that do not depend on a lens.
void read_place(PluginReader& plugin, SceneDescription& scene) {
  plugin.settings(scene, "camera", kPlace);
  const glm::dmat4 to_world = plugin.transform("to_world");
  if (const auto frame = without_scale(to_world)) {
    scene.camera.to_world = *frame;
  } else {
    plugin.wrong("to_world", frame.error().message);
  }
  // Scale enlarges the film of an orthographic camera, and also its near clipping distance.
  if (scene.camera.projection == Projection::kOrthographic) {
    const glm::dmat3 axes(to_world);
    scene.camera.scale_x = glm::length(axes[0]);
    scene.camera.scale_y = glm::length(axes[1]);
    const double length = scene.camera.far_clip - scene.camera.near_clip;
    scene.camera.near_clip *= glm::length(axes[2]);
    scene.camera.far_clip = scene.camera.near_clip + length;
  }
  read_shutter(plugin);
  if (!plugin.boolean("jitter", true)) plugin.warn("samples are spread over their pixels all the same");
  plugin.accept({"cone_scale"});  // about texture filtering, which does not exist here
}

void read_lens(PluginReader& plugin, SceneDescription& scene) {
  plugin.settings(scene, "camera", kLens);
  if (!plugin.has("focus_distance")) scene.camera.focus_distance = scene.camera.far_clip;
  if (!plugin.has("aperture_radius")) {
    plugin.wrong(fmt::format("{} needs an aperture_radius", plugin.title()));
  } else if (scene.camera.aperture_radius == 0.0) {
    plugin.warn("with an aperture_radius of 0 it is a pinhole");
  }
}

void read_distortion(PluginReader& plugin, SceneDescription& scene) {
  plugin.settings(scene, "camera", kDistortion);
}

void read_perspective(PluginReader& plugin, SceneDescription& scene) {
  read_view_angle(plugin, scene);
  read_place(plugin, scene);
  read_distortion(plugin, scene);
  plugin.accept({"focus_distance"});  // of a lens that it does not have
}

void read_thin_lens(PluginReader& plugin, SceneDescription& scene) {
  read_view_angle(plugin, scene);
  read_place(plugin, scene);
  read_lens(plugin, scene);
  read_distortion(plugin, scene);
}

/// Mitsuba 0.6's camera with distortion; kc contains both coefficients.
void read_distorted_perspective(PluginReader& plugin, SceneDescription& scene) {
  read_view_angle(plugin, scene);
  read_place(plugin, scene);
  const auto numbers = parse_numbers(plugin.text("kc", "0, 0"));
  if (!numbers || numbers->size() != 2) {
    plugin.wrong("kc", fmt::format("kc: '{}' is not two numbers, k1 and k2", plugin.text("kc", "")));
  } else {
    scene.camera.distortion_k1 = (*numbers)[0];
    scene.camera.distortion_k2 = (*numbers)[1];
  }
  plugin.accept({"focus_distance"});
}

void read_orthographic(PluginReader& plugin, SceneDescription& scene) {
  scene.camera.projection = Projection::kOrthographic;
  read_place(plugin, scene);
  plugin.accept({"focus_distance"});
}

/// Mitsuba 0.6's orthographic camera with a lens.
void read_telecentric(PluginReader& plugin, SceneDescription& scene) {
  scene.camera.projection = Projection::kOrthographic;
  read_place(plugin, scene);
  read_lens(plugin, scene);
}

/// A panorama may have a lens.
void read_panorama(PluginReader& plugin, const PanoramaPlugin& panorama, SceneDescription& scene) {
  scene.camera.projection = panorama.projection;
  plugin.settings(scene, "camera", panorama.parameters);
  read_place(plugin, scene);
  plugin.settings(scene, "camera", kLens);
  if (!plugin.has("focus_distance")) scene.camera.focus_distance = scene.camera.far_clip;
}

void read_filter(const Context& context, const Object& object, SceneDescription& scene) {
  PluginReader plugin(context, object);
  const auto* filter = find_plugin(kFilters, object.type);
  if (filter == nullptr) {
    context.unknown_plugin(object, plugin_types(kFilters), "a gaussian stands in for it");
    return;
  }
  choose(plugin, scene, "film.rfilter", filter->ours);
  if (filter->type == "catmullrom") {  // Mitchell and Netravali 1988, section 3: B = 0, C = 1/2
    scene.film.filter_b = 0.0f;
    scene.film.filter_c = 0.5f;
  }
  if (filter->type == "lanczos") {  // its radius is the number of lobes
    std::int64_t lobes = kFilterLobes;
    plugin.read("lobes", lobes, WholeNumber{1, kMostFilterLobes});
    scene.film.filter_radius = float(lobes);
  }
  plugin.settings(scene, "film", filter->parameters, "rfilter_");
  plugin.finish();
}

/// Of Mitsuba's pixel formats, in any capitalisation, only alpha is used. The image is always RGB.
void read_format(PluginReader& plugin, Film& film) {
  const OneOf<bool> formats{{{"rgb", false},
                             {"rgba", true},
                             {"luminance", false},
                             {"luminance_alpha", true},
                             {"luminancealpha", true},
                             {"xyz", false},
                             {"xyza", true},
                             {"spectrum", false},
                             {"spectrum_alpha", true},
                             {"spectrumalpha", true}}};
  const std::string given = plugin.text("pixel_format", "rgb"), format = to_lower_case(given);
  const Expected<bool> alpha = formats.parse(format);
  if (alpha)
    film.alpha = *alpha;
  else
    plugin.wrong("pixel_format", fmt::format("pixel_format: {}", alpha.error().message));
  if (alpha && !format.starts_with("rgb"))
    plugin.warn(fmt::format("a pixel_format of {} is written as {}", given, film.alpha ? "rgba" : "rgb"));
  plugin.read("component_format", film.half,
              OneOf<bool>{{{"float32", false}, {"float16", true}, {"uint32", false}}});
}

void read_film(const Context& context, const Object& object, SceneDescription& scene) {
  PluginReader plugin(context, object);
  plugin.settings(scene, "film", kFilmSize);
  const Object* filter = plugin.only_nested("rfilter");
  if (find_plugin(kFilms, object.type) != nullptr) {
    read_format(plugin, scene.film);
    // How Mitsuba writes its files. Here command-line options determine that.
    plugin.accept({"file_format", "gamma", "banner", "attach_log", "high_quality_edges", "exposure",
                   "tonemap_method", "key", "burn", "sample_border", "compensate", "filename", "variable",
                   "digits"});
  } else {
    context.unknown_plugin(object, plugin_types(kFilms), "an hdrfilm stands in for it");
    plugin.skip();
  }
  plugin.finish();
  if (filter != nullptr) read_filter(context, *filter, scene);
}

void read_shown_sampler(const Context& context, const Object& object, SceneDescription& scene) {
  PluginReader plugin(context, object);
  plugin.settings(scene, "sampler", kSamplerSettings);
  if (const auto* sampler = find_plugin(kSamplers, object.type)) {
    choose(plugin, scene, "sampler.type", sampler->nearest);
    plugin.accept({"jitter", "scramble", "dimension", "strength"});
  } else {
    context.unknown_plugin(object, plugin_types(kSamplers), "sobol stands in for it");
    plugin.skip();
  }
  plugin.finish();
}

/// If the command line replaces the sampler, problems with this one are not reported, as for integrators.
void read_sampler(const Context& context, const Object& object, SceneDescription& scene) {
  if (!context.is_replaced("sampler.type")) return read_shown_sampler(context, object, scene);
  Diagnostics unseen;
  read_shown_sampler({context.tree, unseen, true, context.settings}, object, scene);
}

struct SensorPlugin {
  std::string_view type;
  void (*read)(PluginReader&, SceneDescription&);
};
constexpr SensorPlugin kSensors[] = {{"perspective", read_perspective},
                                     {"thinlens", read_thin_lens},
                                     {"orthographic", read_orthographic},
                                     {"telecentric", read_telecentric},
                                     {"perspective_rdist", read_distorted_perspective}};

/// Reports keys at which the camera would be sheared.
void check_keys(const PluginReader& plugin, std::span<const TransformKey> keys,
                const CameraSettings& camera) {
  for (const auto& [time, transform] : keys)
    if (const auto frame = without_scale(transform); !frame)
      return plugin.wrong("to_world", fmt::format("at {} s {}", time, frame.error().message));
  const auto length = [](const TransformKey& key) { return glm::length(glm::dvec3(key.transform[2])); };
  if (camera.projection == Projection::kOrthographic &&
      std::ranges::any_of(keys, [&](const TransformKey& key) {
        return std::abs(length(key) - length(keys.front())) > 1e-6 * length(key);
      }))
    plugin.warn("near_clip stays as when the shutter opens, while the scale along the view changes");
}

}  // namespace

void read_sensor(const Context& context, const Object& object, std::span<const TransformKey> keys,
                 SceneDescription& scene) {
  PluginReader plugin(context, object);
  const SensorPlugin* known = find_plugin(kSensors, object.type);
  const PanoramaPlugin* panorama = find_plugin(kPanoramas, object.type);
  if (panorama != nullptr)
    read_panorama(plugin, *panorama, scene);
  else
    (known != nullptr ? *known : kSensors[0]).read(plugin, scene);
  check_keys(plugin, keys, scene.camera);
  const Object* film = plugin.only_nested("film");
  const Object* sampler = plugin.only_nested("sampler");
  if (const Object* medium = plugin.only_nested("medium"))
    scene.camera_medium = context.media->install(*medium, scene);
  if (known == nullptr && panorama == nullptr) {
    std::vector<std::string> types = plugin_types(kSensors);
    std::ranges::copy(plugin_types(kPanoramas), std::back_inserter(types));
    context.unknown_plugin(object, types, "a perspective one stands in for it");
    plugin.skip();
  }
  plugin.finish();
  if (film != nullptr) read_film(context, *film, scene);
  if (sampler != nullptr) read_sampler(context, *sampler, scene);
}

}  // namespace penumbra::mitsuba
