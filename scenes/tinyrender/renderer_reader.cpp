#include "scenes/tinyrender/renderer_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <map>

namespace penumbra::tinyrender {
namespace {

using Names = std::vector<std::string>;

/// Everything that a [renderer] of any type may hold.
const Names kAllKeys = {"type",        "realtime",      "method",     "samplingStrategy", "emitterSamples",
                        "bsdfSamples", "alpha",         "visSamples", "traceShadows",     "bonus",
                        "spp",         "test",          "maxDepth",   "rrDepth",          "rrProb",
                        "isExplicit",  "sampling_type", "exponent",   "samplesByVertex"};

/// "Solid_Angle" and "solidAngle" → "solidangle".
std::string folded(std::string_view name) {
  std::string result;
  for (const char c : name) {
    if (c >= 'A' && c <= 'Z') {
      result += static_cast<char>(c - 'A' + 'a');
    } else if (c != '_' && c != '-' && c != ' ') {
      result += c;
    }
  }
  return result;
}

/// The one of `choices`, in any spelling, that the key names. Nothing, and an error, for another name.
std::optional<std::string> choose(Section& renderer, std::string_view key, const Names& choices) {
  const auto text = renderer.text(key);
  if (!text) return std::nullopt;
  for (const std::string& choice : choices) {
    if (folded(choice) == folded(*text)) return choice;
  }
  renderer.wrong(key, fmt::format("{} '{}' is not one that Penumbra reads{} it reads: {}", key, *text,
                                  suggestion(*text, choices).empty() ? ";" : suggestion(*text, choices),
                                  list_names(choices)));
  return std::nullopt;
}

struct Strategy {
  bool emitters;
  bool directions;
  std::string emitter_sampling;
  std::string bsdf_sampling;
};

void read_direct(Section& renderer, SceneDescription& scene, bool /*realtime*/) {
  static const std::map<std::string, Strategy, std::less<>> kStrategies = {
      {"mis", {true, true, "area", "bsdf"}},        {"emitter", {true, false, "area", "bsdf"}},
      {"area", {true, false, "area", "bsdf"}},      {"solidAngle", {true, false, "solid_angle", "bsdf"}},
      {"bsdf", {false, true, "area", "bsdf"}},      {"cosineHemisphere", {false, true, "area", "cosine"}},
      {"cosine", {false, true, "area", "cosine"}},  {"uniformHemisphere", {false, true, "area", "uniform"}},
      {"uniform", {false, true, "area", "uniform"}}};
  Names names;
  for (const auto& [name, strategy] : kStrategies) names.push_back(name);
  const std::string name = choose(renderer, "samplingStrategy", names).value_or("mis");
  const Strategy& strategy = kStrategies.find(name)->second;
  renderer.imply(scene, "integrator.type", "direct");
  renderer.imply(scene, "integrator.mis", "balance");
  renderer.imply(scene, "integrator.emitter_sampling", strategy.emitter_sampling);
  renderer.imply(scene, "integrator.bsdf_sampling", strategy.bsdf_sampling);
  const auto count = [&](const char* setting, const char* key, bool used) {
    renderer.set(scene, setting, key);
    if (used) return;
    if (renderer.has(key))
      renderer.warn(key, fmt::format("{} has no effect with samplingStrategy = {}", key, name));
    renderer.imply(scene, setting, "0");
  };
  count("integrator.emitter_samples", "emitterSamples", strategy.emitters);
  count("integrator.bsdf_samples", "bsdfSamples", strategy.directions);
  renderer.finish(kAllKeys, "with type = direct");
}

void read_control_variates(Section& renderer, SceneDescription& scene) {
  renderer.imply(scene, "integrator.type", "polygon_cv");
  renderer.imply(scene, "integrator.emitter_sampling", "area");
  renderer.imply(scene, "integrator.alpha", "1");
  renderer.set(scene, "integrator.alpha", "alpha");
  renderer.set(scene, "integrator.vis_samples", "visSamples");
}

void read_area(Section& renderer, SceneDescription& scene) {
  renderer.imply(scene, "integrator.type", "polygon_area");
  renderer.imply(scene, "integrator.emitter_samples", "1");
  renderer.imply(scene, "integrator.emitter_sampling", "area");
  renderer.imply(scene, "integrator.trace_shadows", "false");
  renderer.set(scene, "integrator.trace_shadows", "traceShadows");
}

void read_analytic(Section& renderer, SceneDescription& scene) {
  renderer.imply(scene, "integrator.type", "polygon_analytic");
}

struct PolygonalMethod {
  std::string_view name;
  void (*read)(Section&, SceneDescription&);
};
constexpr PolygonalMethod kMethods[] = {
    {"analytic", read_analytic}, {"area", read_area}, {"controlVariates", read_control_variates}};

template <typename Rows>
Names names_of(const Rows& rows) {
  Names names;
  for (const auto& row : rows) names.emplace_back(row.name);
  return names;
}

void read_polygonal(Section& renderer, SceneDescription& scene, bool realtime) {
  // TinyRender's switch for the closed form of its Phong lobes. Here the material decides whether there is a
  // lobe, so the switch has no effect.
  renderer.boolean("bonus", false);
  const bool test = renderer.boolean("test", false);
  const std::string window = test ? "controlVariates" : "analytic";
  const std::string method =
      choose(renderer, "method", names_of(kMethods)).value_or(realtime ? window : "area");
  std::ranges::find(kMethods, method, &PolygonalMethod::name)->read(renderer, scene);
  renderer.finish(kAllKeys, fmt::format("with method = {}", method));
}

/// TinyRender's 0 bounces show only emitters, which is a path of one edge.
void read_depth(Section& renderer, SceneDescription& scene, const char* setting, const char* key,
                std::int64_t least) {
  const auto bounces = renderer.integer(key);
  if (!bounces) return;
  if (*bounces < least || *bounces >= std::numeric_limits<int>::max()) {
    renderer.wrong(key, fmt::format("{} is not in the range from {} to {}", *bounces, least,
                                    std::numeric_limits<int>::max() - 1));
    return;
  }
  renderer.imply(scene, setting, fmt::format("{}", *bounces < 0 ? -1 : *bounces + 1), key);
}

void read_path(Section& renderer, SceneDescription& scene, bool /*realtime*/) {
  const bool samples_emitters = renderer.boolean("isExplicit", true);
  renderer.imply(scene, "integrator.type", samples_emitters ? "path" : "path_mats");
  renderer.imply(scene, "integrator.emitter_sampling", "area");
  read_depth(renderer, scene, "integrator.max_depth", "maxDepth", -1);
  read_depth(renderer, scene, "integrator.rr_depth", "rrDepth", 0);
  // Here Russian roulette depends on the throughput, not on a fixed probability.
  renderer.accept("rrProb");
  renderer.finish(kAllKeys, "with type = path");
}

/// TinyRender bakes light into vertices with `samplesByVertex` paths each; here every pixel gets that many.
void read_baked(Section& renderer, SceneDescription& scene, bool /*realtime*/) {
  const bool samples_emitters = renderer.boolean("isExplicit", true);
  renderer.imply(scene, "integrator.type", samples_emitters ? "path" : "path_mats");
  renderer.imply(scene, "integrator.emitter_sampling", "area");
  renderer.imply(scene, "integrator.max_depth", "6");
  read_depth(renderer, scene, "integrator.max_depth", "maxDepth", -1);
  read_depth(renderer, scene, "integrator.rr_depth", "rrDepth", 0);
  renderer.accept("rrProb");
  if (renderer.has("spp")) {
    renderer.accept("samplesByVertex");
  } else {
    renderer.imply(scene, "sampler.sample_count", "100");
    renderer.set(scene, "sampler.sample_count", "samplesByVertex");
  }
  for (const char* key : {"bonus", "test"}) renderer.accept(key);
  renderer.finish(kAllKeys, "with type = gi");
}

/// Rays have half the scene's radius; the background is black.
void read_ambient_occlusion(Section& renderer, SceneDescription& scene, bool /*realtime*/) {
  renderer.imply(scene, "integrator.type", "ao");
  renderer.imply(scene, "integrator.background", "0");
  const auto sampling = choose(renderer, "sampling_type", {"sphere", "hemisphere", "cosine"});
  renderer.imply(scene, "integrator.occlusion_sampling", sampling.value_or("cosine"));
  renderer.finish(kAllKeys, "with type = ao");
}

void read_reflection_occlusion(Section& renderer, SceneDescription& scene, bool /*realtime*/) {
  renderer.imply(scene, "integrator.type", "ro");
  renderer.set(scene, "integrator.exponent", "exponent");
  renderer.finish(kAllKeys, "with type = ro");
}

struct RendererType {
  std::string_view name;
  bool has_window;  ///< with `realtime`, what its window shows is rendered
  void (*read)(Section&, SceneDescription&, bool realtime);
};
// The first one replaces unknown types.
constexpr RendererType kTypes[] = {{"direct", false, read_direct},
                                   {"polygonal", true, read_polygonal},
                                   {"path", false, read_path},
                                   {"gi", true, read_baked},
                                   {"ao", false, read_ambient_occlusion},
                                   {"ro", false, read_reflection_occlusion}};

}  // namespace

void read_renderer(const Context& context, SceneDescription& scene) {
  Section renderer(context, "renderer");
  renderer.require("type");
  renderer.imply(scene, "sampler.sample_count", "1");
  renderer.set(scene, "sampler.sample_count", "spp");
  const bool realtime = renderer.boolean("realtime", false);
  const std::string name = renderer.text("type").value_or("direct");
  const RendererType* type = std::ranges::find(kTypes, name, &RendererType::name);
  if (type == std::end(kTypes)) {
    const Names known = names_of(kTypes);
    const std::string hint = suggestion(name, known);
    context.unknown(renderer.location("type"),
                    fmt::format("renderer type '{}' is not one that Penumbra reads{} it reads: {}", name,
                                hint.empty() ? ";" : hint, list_names(known)),
                    "direct stands in for it");
    type = kTypes;
    if (!context.lenient) return;  // its other keys belong to an unknown type
  }
  if (!type->has_window) {
    if (realtime)
      renderer.warn(
          "realtime",
          fmt::format("what the window shows for type = {} is not read; it is rendered offline", type->name));
    for (const char* key : {"bonus", "test"}) renderer.accept(key);
  }
  type->read(renderer, scene, realtime);
}

}  // namespace penumbra::tinyrender
