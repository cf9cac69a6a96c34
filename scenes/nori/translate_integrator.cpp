#include <fmt/format.h>

#include <algorithm>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "kernels/scene_types.h"
#include "scenes/diagnostic.h"
#include "scenes/nori/translate.h"

namespace penumbra::nori {

using mitsuba::Child;
using mitsuba::Object;
using mitsuba::Parameter;
using mitsuba::RgbValue;
using mitsuba::Value;

namespace {

constexpr const char* kSimple = "simple";
constexpr const char* kMaterial = "material";

/// Integrators, and our settings that make the same image.
struct Integrator {
  const char *nori, *ours;
  std::vector<std::pair<const char*, Value>> settings = {};
};
const std::vector<Integrator>& integrators() {
  using I = std::int64_t;
  static const std::vector<Integrator> all = {
      {"path", "path_mis"},
      {"path_mis", "path_mis"},
      {"path_mats", "path_mats"},
      {"path_ems", "path_ems"},
      {"direct", "direct"},
      {"direct_mis", "direct"},
      {"direct_mats", "direct", {{"emitter_samples", I(0)}, {"bsdf_samples", I(1)}}},
      {"direct_ems", "direct", {{"emitter_samples", I(1)}, {"bsdf_samples", I(0)}}},
      {"direct_whitted", "whitted", {{"indirect_samples", I(0)}}},
      {"whitted", "whitted", {{"indirect_samples", I(0)}}},
      {kSimple, "direct", {{"emitter_samples", I(1)}, {"bsdf_samples", I(0)}}},
      {"normals", "normals"},
      {kMaterial, "path_mats", {{"max_depth", I(1)}}},
      // They differ in rays that leave the scene: black in the one, white in the other.
      {"ao", "ao", {{"ray_length", 0.0}, {"background", 0.0}}},
      {"av",
       "ao",
       {{"occlusion_sampling", std::string("hemisphere")},
        {"occlusion_weighting", std::string("uniform")},
        {"background", 1.0}}},
      {"volpath", "volpath"},
      {"volpath_mis", "volpath"},
      {"volpath_mats", "volpath_mats"}};
  return all;
}

/// Ours for photon mapping under its many names; empty for other integrators.
std::string_view photon_mapper(std::string_view plain) {
  const auto has = [&](std::string_view word) { return plain.find(word) != plain.npos; };
  if (has("ppm") || has("progressivephoton")) return "ppm";
  return has("photon") || has("photomap") || has("pmap") ? "photonmapper" : "";
}

/// The substitute for an integrator of a fork, by its name: path tracers that converge to the same image.
/// Empty: none.
std::string_view substitute_for(std::string_view plain) {
  const auto has = [&](std::string_view word) { return plain.find(word) != plain.npos; };
  const bool by_bsdf = has("mats");
  if (has("vol") || has("medi")) return by_bsdf ? "volpath_mats" : "volpath";
  for (const std::string_view word : {"bdpt", "bidir", "mlt", "pssmlt", "vpl", "vcm", "guid", "radiosity",
                                      "ptracer", "lighttrac", "particle", "restir"})
    if (has(word)) return "path_mis";
  if (has("direct")) return "direct";
  if (has("path") || plain == "pt") return by_bsdf ? "path_mats" : has("ems") ? "path_ems" : "path_mis";
  return "";
}

/// Parameters that ours have, by the forks' names; the rest is of their own ways to work.
void settle_parameters(Object& integrator, std::initializer_list<std::string_view> more = {}) {
  rename(integrator, {"length"}, "ray_length");
  rename(integrator, {"maxdepth", "max_bounces", "max_path_length"}, "max_depth");
  std::erase_if(integrator.parameters, [&](const Parameter& parameter) {
    return parameter.name != "ray_length" && parameter.name != "max_depth" && parameter.name != "rr_depth" &&
           parameter.name != "position" && parameter.name != "energy" &&
           std::ranges::find(more, parameter.name) == more.end();
  });
}

/// One map of all photons, and all of its photons within a radius.
void translate_photon_map(Object& integrator) {
  rename(integrator, {"radius", "initial_radius"}, "photon_radius");
  settle_parameters(integrator, {"photon_count", "photon_radius"});
  set_default(integrator, "photon_count", std::int64_t(1'000'000));
  Parameter count = *take(integrator, "photon_count");
  for (const char* map : {"global_photons", "caustic_photons", "volume_photons"}) {
    count.name = map;
    integrator.parameters.push_back(count);
  }
  // Nori's radius if none is given: 1/500 of the diagonal of the scene's bounding box. The diagonal is two
  // radii of the bounding sphere.
  for (const char* radius : {"global_lookup_radius", "caustic_lookup_radius", "volume_lookup_radius"})
    set(integrator, radius, 2.0 / 500.0);
  set(integrator, "lookup_size", std::int64_t(MAX_PHOTONS));
}

void translate_progressive_photons(const Translation& t, Object& integrator) {
  rename(integrator, {"radius", "photon_radius"}, "initial_radius");
  rename(integrator, {"photon_alpha"}, "alpha");
  if (const auto given =
          take_any(integrator, {"iterations", "iteration", "num_iterations", "iter_count", "passes"}))
    t.report.warn(
        given->location,
        fmt::format("{} is ignored; the samples per pixel decide how many maps of photons there are",
                    given->name));
  settle_parameters(integrator, {"photon_count", "initial_radius", "alpha"});
}

}  // namespace

void translate_integrator(const Translation& t, Object& integrator) {
  if (const std::string_view ours = photon_mapper(plain_name(integrator.type)); !ours.empty()) {
    integrator.type = ours;
    return ours == "ppm" ? translate_progressive_photons(t, integrator) : translate_photon_map(integrator);
  }
  const auto& known = integrators();
  const auto found =
      std::ranges::find_if(known, [&](const Integrator& each) { return integrator.type == each.nori; });
  if (found != known.end()) {
    rename(integrator, {"length"}, "ray_length");
    if (integrator.type == kSimple || integrator.type == kMaterial)
      integrator.id = integrator.type;  // for apply_integrator
    integrator.type = found->ours;
    for (const auto& [name, value] : found->settings) set_default(integrator, name, value);
    return;
  }
  std::string_view ours = substitute_for(plain_name(integrator.type));
  if (!ours.empty()) {
    t.report.warn(integrator.type_location,
                  fmt::format("{} stands in for the integrator '{}'", ours, integrator.type));
    settle_parameters(integrator);
  } else {
    std::vector<std::string> names;
    for (const Integrator& each : known) names.emplace_back(each.nori);
    names.insert(names.end(), {"photonmapper", "ppm"});
    t.report.unsupported(integrator.type_location,
                         fmt::format("integrator type '{}' is not one of Nori's that Penumbra reads{}",
                                     integrator.type, known_names(integrator.type, names, "It reads")),
                         "path_mis stands in for it");
    ours = "path_mis";
    integrator.parameters.clear();
  }
  integrator.type = ours;
}

namespace {

void remove(Object& object, std::initializer_list<std::string_view> tags) {
  std::erase_if(object.children,
                [&](const Child& child) { return std::ranges::find(tags, child.object->tag) != tags.end(); });
}

/// `simple` is a point light of its own, before surfaces that are white whatever the scene says.
void apply_simple(const Translation& t, Object& integrator, Object& scene) {
  Object& light = t.new_object("emitter", "point", integrator.location);
  if (auto position = take(integrator, "position")) light.parameters.push_back(std::move(*position));
  const auto energy = take(integrator, "energy");
  const glm::vec3 power = energy ? colour_of(*energy).value_or(glm::vec3(0.0f)) : glm::vec3(0.0f);
  set(light, "intensity", RgbValue{power * float(0.25 / std::numbers::pi)});
  remove(scene, {"emitter"});
  for (const Child& each : scene.children) {
    if (each.object->tag != "shape") continue;
    remove(*each.object, {"bsdf", "emitter"});
    Object& white = t.new_object("bsdf", "diffuse", each.object->location);
    set(white, "reflectance", RgbValue{glm::vec3(1.0f)});
    add_child(*each.object, white);
  }
  add_child(scene, light);
}

/// What `material` shows of a diffuse BSDF, as a light.
Object& shown_material(const Translation& t, Object& diffuse) {
  constexpr float kInversePi = float(std::numbers::inv_pi);
  Object& area_light = t.new_object("emitter", "area", diffuse.location);
  if (const Child* texture = find_child(diffuse, "texture", {"reflectance"})) {
    Object& scaled = t.new_object("texture", "scale", texture->location);
    set(scaled, "scale", double(kInversePi));
    add_child(scaled, *texture->object);
    add_child(area_light, scaled, "radiance");
  } else {
    const Parameter* given = find(diffuse, "reflectance");
    const glm::vec3 albedo = given != nullptr ? colour_of(*given).value_or(glm::vec3(0.5f)) : glm::vec3(0.5f);
    set(area_light, "radiance", RgbValue{albedo * kInversePi});
  }
  return area_light;
}

/// `material` shows the values of BSDFs for light along the normal: of diffuse ones as if they shone, of
/// mirrors and glass nothing.
void apply_material(const Translation& t, Object& scene) {
  remove(scene, {"emitter"});
  for (const Child& each : scene.children) {
    if (each.object->tag != "shape") continue;
    Object& shape = *each.object;
    Object& bsdf = *find_child(shape, "bsdf")->object;
    if (bsdf.type != "diffuse" && bsdf.type != "conductor" && bsdf.type != "dielectric")
      t.report.unsupported(
          bsdf.type_location,
          fmt::format("the integrator 'material' shows diffuse surfaces, mirrors and dielectrics here, "
                      "none of {}",
                      bsdf.type),
          "it is black");
    remove(shape, {"bsdf", "emitter"});
    if (bsdf.type == "diffuse") add_child(shape, shown_material(t, bsdf));
  }
}

}  // namespace

void apply_integrator(const Translation& t, Object& scene) {
  const Child* child = find_child(scene, "integrator");
  if (child == nullptr) return;
  Object& integrator = *child->object;
  const std::string name = std::exchange(integrator.id, "");
  if (name == kSimple) apply_simple(t, integrator, scene);
  if (name == kMaterial) apply_material(t, scene);
}

}  // namespace penumbra::nori
