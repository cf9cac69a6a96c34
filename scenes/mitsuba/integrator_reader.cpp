#include "scenes/mitsuba/integrator_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <set>

#include "scenes/names.h"
#include "scenes/number.h"
#include "scenes/settings.h"

namespace penumbra::mitsuba {
namespace {

using Names = std::vector<std::string>;

/// Integrators that wrap another one.
struct WrapperPlugin {
  std::string_view type;
  std::string_view without;  ///< what is lost without the wrapper; empty: nothing
};
constexpr std::string_view kAov = "aov", kIrradianceCache = "irrcache";
constexpr WrapperPlugin kWrappers[] = {{"moment", ""},
                                       {kAov, ""},
                                       {"stokes", "polarisation"},
                                       {"adaptive", ""},  // here every pixel has the same number of samples
                                       {kIrradianceCache, "its cache, so that nothing is interpolated"},
                                       {"multichannel", ""}};

/// A quantity that `aov` knows, and the layer that shows it. Every image has depth, albedo and shading
/// normals.
struct AovQuantity {
  std::string_view type;
  std::optional<AskedLayer> layer = {};
  bool is_shown = true;
};
constexpr AovQuantity kQuantities[] = {{"depth"},
                                       {"albedo"},
                                       {"sh_normal"},
                                       {"position", AskedLayer::kPosition},
                                       {"uv", AskedLayer::kUv},
                                       {"geo_normal", AskedLayer::kGeometricNormal},
                                       {"shape_index", AskedLayer::kShape},
                                       {"prim_index", {}, false},
                                       {"dp_du", {}, false},
                                       {"dp_dv", {}, false},
                                       {"duv_dx", {}, false},
                                       {"duv_dy", {}, false},
                                       {"boundary_test", {}, false}};

/// Asks for the layers of the quantities in `name:quantity, …`, in addition to those that `layers` has. The
/// names are not used. Warns about quantities for which there is no layer.
void read_aovs(const Context& context, PluginReader& plugin, std::vector<AskedLayer>& layers) {
  const std::string text = plugin.text("aovs", "");
  const Expected<std::vector<std::string_view>> entries = split_list(text);
  if (!entries) return plugin.wrong("aovs", fmt::format("aovs: {}", entries.error().message));
  Names missing;
  std::set<AskedLayer> asked(layers.begin(), layers.end());
  for (const std::string_view entry : *entries) {
    const std::string_view quantity = entry.substr(entry.find(':') + 1);  // npos + 1 = 0: the whole
    const AovQuantity* known = find_plugin(kQuantities, quantity);
    if (known == nullptr) {
      const Names names = plugin_types(kQuantities);
      context.tolerable(plugin.location_of("aovs"),
                        fmt::format("aovs: '{}' is not one of: {}{}", quantity, list_names(names),
                                    suggestion(quantity, names)),
                        "it is left out");
    } else if (!known->is_shown) {
      missing.emplace_back(quantity);
    } else if (known->layer) {
      asked.insert(*known->layer);
    }
  }
  layers.assign(asked.begin(), asked.end());
  if (!missing.empty()) plugin.warn(fmt::format("the image has no layer of {}", list_names(missing)));
}

/// Returns the innermost integrator, inside all wrappers. Adds the layers that wrappers ask for.
const Object* unwrap(const Context& context, const Object& object, std::vector<AskedLayer>& layers) {
  const Object* inner = &object;
  for (int depth = 0; inner != nullptr; ++depth) {
    const WrapperPlugin* wrapper = find_plugin(kWrappers, inner->type);
    if (wrapper == nullptr) break;
    PluginReader plugin(context, *inner);
    // Several nested integrators make several images; the first is the main image.
    const std::vector<const Object*> inside = plugin.nested("integrator");
    const Object* next = inside.empty() ? nullptr : inside.front();
    plugin.accept({"aovs", "max_error", "p_value", "max_sample_factor", "resolution", "quality",
                   "quality_adjustment", "gradients", "clamp_neighbor", "clamp_screen", "overture",
                   "indirect_only", "debug"});
    plugin.finish();
    if (inner->type == kAov) {
      read_aovs(context, plugin, layers);
      if (next == nullptr && depth <= 16) {
        plugin.warn("aov has no integrator inside; direct light makes the image that its layers are beside");
        static const Object direct{"integrator", "direct", {}, {}, {}, {}, {}};
        return &direct;
      }
    }
    if (next == nullptr || depth > 16)
      plugin.wrong(fmt::format("{} needs an <integrator> to work on", plugin.title()));
    else if (!wrapper->without.empty())
      plugin.warn(fmt::format("{} is rendered without {}", next->type, wrapper->without));
    if (inside.size() > 1)
      plugin.warn(fmt::format("the first of {} integrators is rendered, {}", inside.size(), next->type));
    inner = depth > 16 ? nullptr : next;
  }
  return inner;
}

/// Mitsuba's other integrators for the light transport of `path` and `volpath`, with their own parameters.
constexpr std::string_view kThroughMedia = "";  // volpath if the scene has media, else path
struct Substitute {
  std::string_view type;
  bool same;  ///< without media the substitute's samples are the same
  std::vector<std::string_view> parameters;
  std::string_view method = kThroughMedia;
};
const std::vector<Substitute>& substitutes() {
  static const std::vector<Substitute> all = {
      {"volpath_simple", true, {}, "volpath"},
      // Mitsuba 3's integrators for differentiation; they differ only in gradients.
      {"prb", true, {}, "path"},
      {"prb_basic", true, {}, "path"},
      {"prb_projective", true, {"sppc", "sppp", "sppi", "guiding", "guiding_proj", "guiding_rounds"}, "path"},
      {"prb_threepoint", true, {}, "path"},
      {"direct_projective",
       true,
       {"sppc", "sppp", "sppi", "guiding", "guiding_proj", "guiding_rounds"},
       "direct"},
      {"prbvolpath", true, {}, "volpath"},
      {"bdpt", false, {"light_image", "sample_direct"}},
      {"ptracer", false, {"granularity", "brute_force"}},
      {"pssmlt",
       false,
       {"bidirectional", "direct_samples", "luminance_samples", "two_stage", "p_large", "separate_direct"}},
      {"mlt",
       false,
       {"direct_samples", "luminance_samples", "two_stage", "bidirectional_mutation", "lens_perturbation",
        "multi_chain_perturbation", "caustic_perturbation", "manifold_perturbation", "lambda",
        "separate_direct"}},
      {"erpt",
       false,
       {"num_chains", "max_chains", "chain_length", "direct_samples", "bidirectional_mutation",
        "lens_perturbation", "multi_chain_perturbation", "caustic_perturbation", "manifold_perturbation",
        "lambda", "separate_direct"}},
      {"vpl", false, {"shadow_map_resolution", "clamping"}},
      // Of research forks.
      {"guided_path",
       false,
       {"spp_per_pass", "nee", "budget_type", "budget", "s_tree_threshold", "do_filtered_splatting"}},
      {"path_guiding_integrator", false, {}},
      // EARS (Rath et al. 2022, github.com/iRath96/ears): its roulette and splitting change the noise only.
      {"recursive_path", false, {"rrs_strategy", "splitting_min", "splitting_max", "rr_depth", "budget"}},
      {"restirpt", false, {"photon_count", "initial_radius", "alpha", "max_passes"}}};
  return all;
}

/// Parameters that Mitsuba's integrators have and ours do not need: how work is divided and branched.
struct UnneededParameters {
  std::string_view type;
  std::vector<std::string_view> names;
};
const std::vector<UnneededParameters>& unneeded_parameters() {
  static const std::vector<UnneededParameters> all = {
      {"volpathmis", {"use_spectral_mis"}},
      {"photonmapper",
       {"direct_samples", "glossy_samples", "max_specular_depth", "granularity", "gather_locally",
        "auto_cancel_gathering"}},
      {"ppm", {"granularity", "auto_cancel_gathering"}},
      {"sppm", {"granularity", "auto_cancel_gathering"}}};
  return all;
}

/// Mitsuba's progressive photon mapping ignores the sampler, and has its own limit instead.
void warn_of_passes(PluginReader& plugin) {
  static constexpr const char* kPasses = "max_passes";
  if (!plugin.has(kPasses)) return;
  plugin.accept({kPasses});
  plugin.warn("max_passes is ignored; the samples per pixel decide how many maps of photons there are");
}

/// Accepts parameters about how Mitsuba divides its work, and a rule about shading normals that version 3 has
/// dropped.
void accept_scheduling_parameters(PluginReader& plugin) {
  plugin.accept({"strict_normals", "samples_per_pass", "block_size", "timeout"});
}

/// The integrator that simulates all light transport of the scene.
std::string_view path_tracer_of(const Context& context) {
  const bool media =
      std::ranges::any_of(context.tree.objects, [](const Object& each) { return each.tag == "medium"; });
  return media ? "volpath" : "path";
}

void read_substitute(const Context& context, PluginReader& plugin, const Substitute& substitute,
                     SceneDescription& scene) {
  const std::string_view ours =
      substitute.method != kThroughMedia ? substitute.method : path_tracer_of(context);
  if (const auto done = apply_setting(scene, "integrator.type", ours); !done)
    plugin.wrong(done.error().message);
  Names names{"hide_emitters", "hidden_emitters"};
  if (ours != "direct") names.insert(names.end(), {"max_depth", "rr_depth"});
  for (const std::string_view parameter : substitute.parameters) std::erase(names, parameter);
  plugin.settings(scene, "integrator", names);
  accept_scheduling_parameters(plugin);
  for (const std::string_view parameter : substitute.parameters) plugin.accept({parameter});
  plugin.finish();
  if (!substitute.same)
    plugin.warn(fmt::format("{} stands in for the integrator '{}'", ours, substitute.type));
}

/// The names of the scene's integrator parameters, except those that the integrator's name determines.
Names integrator_parameter_names(const SceneDescription& scene, std::string_view type) {
  const bool preset = type != method_name(scene.integrator.method);
  Names names;
  for (const Setting& setting : all_settings())
    if (setting.key.starts_with("integrator.") && setting.name() != "type" && setting.belongs_to(scene) &&
        !(preset && setting.name() == "direct_sampling"))
      names.push_back(setting.name());
  return names;
}

/// lajolla's volpath has a version for each exercise of its course (github.com/BachiLi/lajolla_public): 1 is
/// light behind an absorbing medium, 2 adds what is scattered once, 3 and 4 what is scattered more often.
/// Surfaces scatter no light in them. Any other number is the whole.
void read_lajolla_version(PluginReader& plugin, SceneDescription& scene) {
  auto* const path = std::get_if<VolpathIntegrator>(&scene.integrator.method);
  if (path == nullptr || !plugin.is_of_version_0() || !plugin.has("version")) return;
  plugin.accept({"max_null_collisions"});
  const double version = plugin.number("version", 0.0);
  if (version == 1.0)
    plugin.warn("in version 1 of lajolla's volpath media absorb alone; here they also scatter away");
  if (version == 2.0 || version == 3.0 || version == 4.0)
    plugin.warn(
        fmt::format("in version {} of lajolla's volpath surfaces scatter no light; here they do", version));
  if (version != 1.0 && version != 2.0) return;
  const int most = version == 1.0 ? 1 : 2;
  if (path->max_depth < 0 || path->max_depth > most) path->max_depth = most;
}

/// lajolla's integrators that show what is seen, not its light, and where such numbers are to be had.
struct UnreadIntegrator {
  std::string_view type, words;
};
constexpr UnreadIntegrator kUnreadIntegrators[] = {
    {"depth", "the image of every other integrator has a layer 'depth'"},
    {"shading_normal", "the image of every other integrator has layers 'normal'"},
    {"mean_curvature", "nothing here shows curvatures"},
    {"ray_differential", "nothing here shows the footprints of rays"},
    {"mipmap_level", "textures have no levels here"}};

/// Reads an integrator and reports all problems.
void read_shown(const Context& context, const Object& object, SceneDescription& scene) {
  const Object* inner = unwrap(context, object, scene.film.layers);
  if (inner == nullptr) return;
  PluginReader plugin(context, *inner);
  if (const Substitute* substitute = find_plugin(substitutes(), inner->type))
    return read_substitute(context, plugin, *substitute, scene);
  const Names& types = find_setting("integrator.type")->choices;
  if (std::ranges::find(types, inner->type) == types.end()) {
    Names names = plugin_types(kWrappers);
    names.insert(names.end(), types.begin(), types.end());
    const Names others = plugin_types(substitutes());
    names.insert(names.end(), others.begin(), others.end());
    const std::string_view ours = path_tracer_of(context);
    const std::string instead = fmt::format("{} stands in for it", ours);
    if (const auto* unread = find_plugin(kUnreadIntegrators, inner->type))
      context.unsupported(
          inner->type_location,
          fmt::format("integrator type '{}' is not one that Penumbra reads: {}", inner->type, unread->words),
          instead);
    else
      context.unknown_plugin(*inner, names, instead);
    static_cast<void>(apply_setting(scene, "integrator.type", ours));
    plugin.settings(scene, "integrator", Names{"max_depth", "rr_depth", "hide_emitters", "hidden_emitters"});
    return;
  }
  if (const auto done = apply_setting(scene, "integrator.type", inner->type); !done)
    plugin.wrong(done.error().message);
  // The cache does not look up photons at a surface, but one diffuse bounce later.
  if (auto* maps = std::get_if<PhotonMapIntegrator>(&scene.integrator.method))
    maps->final_gather = object.type == kIrradianceCache;
  plugin.settings(scene, "integrator", integrator_parameter_names(scene, inner->type));
  accept_scheduling_parameters(plugin);
  read_lajolla_version(plugin, scene);
  if (const UnneededParameters* unneeded = find_plugin(unneeded_parameters(), inner->type))
    for (const std::string_view name : unneeded->names) plugin.accept({name});
  if (scene.integrator.is<ProgressivePhotonIntegrator>()) warn_of_passes(plugin);
  plugin.finish();
}

}  // namespace

void read_integrator(const Context& context, const Object& object, SceneDescription& scene) {
  if (!context.is_replaced("integrator.type")) return read_shown(context, object, scene);
  // The command line replaces the integrator. Parameters that both have are used; problems with the others
  // are not reported.
  Diagnostics unseen;
  read_shown({context.tree, unseen, true, context.settings}, object, scene);
}

std::string aovs_of(const std::vector<AskedLayer>& layers) {
  std::string aovs;
  for (const AovQuantity& quantity : kQuantities)
    if (quantity.layer && std::ranges::find(layers, *quantity.layer) != layers.end())
      aovs += fmt::format("{}{}:{}", aovs.empty() ? "" : ", ", quantity.type, quantity.type);
  return aovs;
}

std::vector<OtherIntegrator> other_integrators() {
  std::vector<OtherIntegrator> others;
  for (const Substitute& each : substitutes())
    others.push_back({each.type, each.method == kThroughMedia ? "path" : each.method, !each.same});
  for (const WrapperPlugin& each : kWrappers) others.push_back({each.type, "", !each.without.empty()});
  return others;
}

}  // namespace penumbra::mitsuba
