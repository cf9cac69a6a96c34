#include "scenes/plugin_reference.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <type_traits>
#include <variant>

#include "scenes/bsdfs/coating.h"
#include "scenes/mitsuba/integrator_reader.h"
#include "scenes/mitsuba/sensor_parameters.h"
#include "scenes/mitsuba/shape_parameters.h"
#include "scenes/scene_description.h"
#include "scenes/settings.h"
#include "scenes/sky/sky_parameters.h"
#include "scenes/sky/timed_sky.h"

namespace penumbra {
namespace {

using Entries = std::vector<PluginEntry>;

template <typename Values, typename T>
std::string default_of(const Values& values, const T& value) {
  if constexpr (requires { values.print(value); })
    return values.print(value);
  else
    return print_default(value);
}

/// Not inlined into the hundreds of calls in add_model.
[[gnu::noinline]] void add_parameter(PluginEntry& entry, const char* name, std::string values,
                                     std::string default_value, const char* text) {
  entry.parameters.push_back({name, std::move(values), std::move(default_value), text});
}

template <typename Model>
void add_model(Entries& entries, const char* kind) {
  const Model model;
  PluginEntry entry{.kind = kind, .name = Model::kPlugin, .text = Model::kText, .parameters = {}};
  Model::parameters([&](const char* name, auto member, const auto& values, const char* text) {
    using T = std::remove_cvref_t<decltype(model.*member)>;
    const char* nested = kMayBeTexture<T>                   ? ", or a texture"
                         : std::is_same_v<T, GriddedColour> ? ", or a gridvolume"
                                                            : "";
    add_parameter(entry, name, values.values() + nested, default_of(values, model.*member), text);
  });
  entries.push_back(std::move(entry));
}

template <typename... Models>
void add_models(Entries& entries, const char* kind, const std::variant<Models...>*) {
  (add_model<Models>(entries, kind), ...);
}

PluginParameter parameter_of(const Setting& setting, const std::string& name) {
  return {name, setting.values, setting_default(setting), setting.description};
}

/// Adds settings under their names in the plugin.
void add_settings(PluginEntry& entry, const std::string& prefix, const mitsuba::SettingNames& names) {
  for (const std::string& name : names)
    entry.parameters.push_back(parameter_of(*find_setting(prefix + name), name));
}

void add_sensors(Entries& entries) {
  using namespace mitsuba;
  const auto add = [&](const char* name, const char* text, bool has_angle,
                       const std::vector<SettingNames>& parts) {
    PluginEntry entry{.kind = "sensor", .name = name, .text = text, .parameters = {}};
    entry.parameters.push_back({"to_world", "transform", "identity", "camera to world"});
    if (has_angle) {
      entry.parameters.push_back({"focal_length", "length such as 50mm", "50mm",
                                  "instead of fov: of a lens before a film of 36 mm by 24 mm"});
      add_settings(entry, "camera.", kViewAngle);
    }
    for (const SettingNames& names : parts) add_settings(entry, "camera.", names);
    entry.parameters.push_back({"shutter_open", "number", "0", "seconds at which the shutter opens"});
    entry.parameters.push_back({"shutter_close", "number", "0", "seconds at which it closes"});
    entries.push_back(std::move(entry));
  };
  add("perspective", "pinhole camera; holds a film, a sampler and a medium, as all sensors do", true,
      {kPlace, kDistortion});
  add("thinlens", "perspective camera with a lens", true, {kPlace, kLens, kDistortion});
  add("orthographic", "parallel projection; the scale of to_world is half the width of the view", false,
      {kPlace});
  add("telecentric", "parallel projection with a lens", false, {kPlace, kLens});
  add("perspective_rdist", "pinhole camera with radial distortion", true, {kPlace});
  entries.back().parameters.push_back({"kc", "two numbers", "0, 0", "distortion_k1 and distortion_k2"});
  for (const PanoramaPlugin& panorama : kPanoramas)
    add(panorama.type, panorama.text, false, {panorama.parameters, kPlace, kLens});
}

void add_films(Entries& entries) {
  using namespace mitsuba;
  PluginEntry film{.kind = "film",
                   .name = std::string(kFilms[0].type),
                   .text = "size and channels of the image; holds an rfilter",
                   .parameters = {}};
  for (const FilmPlugin& other : kFilms)
    if (other.type != film.name) film.aliases.emplace_back(other.type);
  add_settings(film, "film.", kFilmSize);
  add_settings(film, "film.", {"pixel_format", "component_format"});
  entries.push_back(std::move(film));
  for (const FilterPlugin& filter : kFilters) {
    PluginEntry entry{.kind = "rfilter",
                      .name = std::string(filter.type),
                      .text = std::string(filter.text),
                      .parameters = {}};
    add_settings(entry, "film.rfilter_", filter.parameters);
    if (filter.type == "lanczos")
      entry.parameters.push_back({"lobes", fmt::format("1 to {}", kMostFilterLobes),
                                  fmt::to_string(kFilterLobes), "its radius in pixels"});
    entries.push_back(std::move(entry));
  }
}

void add_samplers(Entries& entries) {
  const std::map<std::string, const char*> texts = {{"independent", "random numbers"},
                                                    {"stratified", "jittered in the strata of a pixel"},
                                                    {"halton", "Halton sequence, scrambled"},
                                                    {"sobol", "Sobol sequence, Owen-scrambled"}};
  for (const std::string& name : find_setting("sampler.type")->choices) {
    PluginEntry entry{.kind = "sampler", .name = name, .text = texts.at(name), .parameters = {}};
    for (const mitsuba::SamplerPlugin& other : mitsuba::kSamplers)
      if (other.nearest == name && other.type != name) entry.aliases.emplace_back(other.type);
    add_settings(entry, "sampler.", mitsuba::kSamplerSettings);
    entries.push_back(std::move(entry));
  }
}

const char* text_of(const IntegratorMethod& method) {
  return std::visit([]<typename Method>(const Method&) { return Method::kText; }, method);
}

void add_integrators(Entries& entries) {
  for (const IntegratorMethod& method : integrator_methods()) {
    PluginEntry entry{
        .kind = "integrator", .name = method_name(method), .text = text_of(method), .parameters = {}};
    for (const auto& [name, preset] : integrator_names())
      if (preset.index() == method.index() && name != entry.name) entry.aliases.emplace_back(name);
    RenderSettings settings;
    settings.integrator.method = method;
    for (const Setting& setting : all_settings())
      if (setting.key.starts_with("integrator.") && setting.name() != "type" && setting.belongs_to(settings))
        entry.parameters.push_back(parameter_of(setting, setting.name()));
    for (const mitsuba::OtherIntegrator& other : mitsuba::other_integrators())
      if (other.rendered_by == entry.name)
        (other.warns ? entry.replaces : entry.aliases).emplace_back(other.name);
    entries.push_back(std::move(entry));
  }
  for (const mitsuba::OtherIntegrator& other : mitsuba::other_integrators())
    if (other.rendered_by.empty())
      entries.push_back({.kind = "integrator",
                         .name = std::string(other.name),
                         .text = "the integrator that it holds is rendered",
                         .parameters = {}});
}

void add_media(Entries& entries) {
  add_models(entries, "medium", static_cast<const MediumKinds*>(nullptr));
  add_model<GridVolumeParameters>(entries, "volume");
  entries.push_back({.kind = "volume",
                     .name = "constvolume",
                     .text = "the same value everywhere",
                     .parameters = {{"value", "number or colour", "1", "the value"}}});
  add_models(entries, "phase", static_cast<const PhasePlugins*>(nullptr));
  add_model<BlendPhase>(entries, "phase");
}

void name_also(Entries& entries, std::string_view name, std::vector<std::string> aliases) {
  std::ranges::find(entries, name, &PluginEntry::name)->aliases = std::move(aliases);
}

Entries make_reference() {
  Entries entries;
  add_models(entries, "bsdf", static_cast<const BsdfModel*>(nullptr));
  add_models(entries, "bsdf", static_cast<const HolderParameters*>(nullptr));
  add_models(entries, "bsdf", static_cast<const CoatingPlugins*>(nullptr));
  add_models(entries, "texture", static_cast<const TextureModel*>(nullptr));
  entries.push_back({.kind = "texture",
                     .name = "rawconstant",
                     .text = "a value that is not converted from a colour space",
                     .parameters = {{"value", "number or vector", "", "the value"}}});
  for (PluginEntry& entry : entries)
    if (entry.kind == "texture")
      entry.parameters.push_back({"to_uv", "transform", "identity", "texture coordinates to its own"});
  add_models(entries, "emitter", static_cast<const Emitter*>(nullptr));
  add_model<AreaLightParameters>(entries, "emitter");
  add_models(entries, "emitter", static_cast<const SkyModels*>(nullptr));
  add_models(entries, "emitter", static_cast<const TimedSkies*>(nullptr));
  add_models(entries, "shape", static_cast<const mitsuba::ShapeParameters*>(nullptr));
  add_media(entries);
  add_sensors(entries);
  add_films(entries);
  add_samplers(entries);
  add_integrators(entries);
  name_also(entries, BumpMapParameters::kPlugin, {"bump"});
  name_also(entries, PolarizerParameters::kPlugin, {"circular", "retarder"});
  name_also(entries, MeshAttributeTexture::kPlugin, {"vertexcolors"});
  return entries;
}

}  // namespace

bool PluginEntry::is_called(std::string_view other) const {
  return name == other || std::ranges::find(aliases, other) != aliases.end() ||
         std::ranges::find(replaces, other) != replaces.end();
}

std::span<const PluginEntry> all_plugins() {
  static const Entries all = make_reference();
  return all;
}

}  // namespace penumbra
