#include <fmt/format.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "scenes/nori/translate.h"
#include "scenes/transform.h"

namespace penumbra::nori {

using mitsuba::Child;
using mitsuba::Object;
using mitsuba::Parameter;
using mitsuba::RgbValue;

namespace {

bool is_homogeneous(std::string_view plain) {
  return plain.starts_with("homo") || plain == "medium" || plain == "uniform" || plain == "constant";
}

/// A box or a ball that the medium says it fills, as a shape around it that light passes through.
Object* shape_of(const Translation& t, Object& medium) {
  const auto center = take_any(medium, {"center", "position", "origin", "box_origin"});
  const auto size = take_any(medium, {"size", "dimensions", "box_size"});
  const auto radius = take_any(medium, {"radius", "max_radius"});
  const auto low = take_any(medium, {"bounds_min", "min", "p_min", "bbox_min"});
  const auto high = take_any(medium, {"bounds_max", "max", "p_max", "bbox_max"});
  const auto of = [](const std::optional<Parameter>& parameter) {
    return parameter ? vector_of(*parameter) : std::nullopt;
  };
  const glm::dvec3 at = of(center).value_or(glm::dvec3(0.0));
  if (const auto r = radius ? number_of(*radius) : std::nullopt) {
    Object& ball = t.new_object("shape", "sphere", medium.location);
    set(ball, "center", at);
    set(ball, "radius", *r);
    return &ball;
  }
  std::optional<glm::dmat4> to_world;
  // Of `size` forks mean half of the box's sides.
  if (const auto half = of(size)) to_world = translation(at) * scaling(glm::abs(*half));
  // The transform of the unit cube from (0, 0, 0) to (1, 1, 1) that the medium fills (beltegeuse/nori).
  if (const auto placed = take(medium, "to_world"))
    if (const auto* matrix = std::get_if<glm::dmat4>(&placed->value))
      to_world = *matrix * translation(glm::dvec3(0.5)) * scaling(glm::dvec3(0.5));
  if (of(low) && of(high))
    to_world = translation(0.5 * (*of(low) + *of(high))) * scaling(0.5 * (*of(high) - *of(low)));
  if (!to_world) return nullptr;
  if (is_singular(*to_world)) {
    t.report.error(medium.location, "the box of the medium must have three sides above 0");
    return nullptr;
  }
  Object& box = t.new_object("shape", "cube", medium.location);
  set(box, "to_world", *to_world);
  return &box;
}

/// Factors of the coefficients, of forks that give colours and a density, or one for each colour.
void settle_density(const Translation& t, Object& medium) {
  if (const auto form = take_any(medium, {"density_function", "density_type"});
      form && number_of(*form) != 1.0)
    t.report.unsupported(
        form->value_location,
        fmt::format("{} {}: a density that varies in the medium is not read; 1, the same everywhere, is",
                    form->name, form->text),
        "it counts as 1");
  for (const auto& [factor, coefficient] :
       {std::pair("density_a", "sigma_a"), std::pair("density_s", "sigma_s")})
    if (const auto given = take(medium, factor)) {
      Parameter* const scaled = find(medium, coefficient);
      const auto colour = scaled != nullptr ? colour_of(*scaled) : std::nullopt;
      const auto number = number_of(*given);
      if (colour && number)
        scaled->value = RgbValue{*colour * float(*number)};
      else
        t.report.warn(given->location, fmt::format("{} multiplies a {} that is a colour; there is none",
                                                   given->name, coefficient));
    }
  if (auto given = take(medium, "max_density")) {
    if (number_of(*given) != 1.0)
      t.report.warn(given->location, "max_density multiplies sigma_a and sigma_s here, and not the albedo");
    const Parameter* const scale = find(medium, "scale");
    const double before = scale != nullptr ? number_of(*scale).value_or(1.0) : 1.0;
    set(medium, "scale", before * number_of(*given).value_or(1.0));
  }
}

/// What scatters and the whole give what is absorbed (beltegeuse/nori).
void settle_extinction(Object& medium) {
  const Parameter* const whole = find(medium, "sigma_t");
  const Parameter* const scattered = find(medium, "sigma_s");
  if (whole == nullptr || scattered == nullptr || find_any(medium, {"sigma_a", "albedo"}) != nullptr) return;
  const auto extinction = colour_of(*whole), scattering = colour_of(*scattered);
  if (!extinction || !scattering) return;
  set(medium, "sigma_a", RgbValue{*extinction - *scattering});
  take(medium, "sigma_t");
}

/// `g` in the medium is that of Henyey and Greenstein.
void settle_phase(const Translation& t, Object& medium) {
  auto g = take(medium, "g");
  if (!g) return;
  if (find_child(medium, "phase") != nullptr)
    return t.report.warn(g->location, "the phase function inside the medium counts, not the medium's g");
  Object& phase = t.new_object("phase", "hg", g->location);
  phase.parameters.push_back(std::move(*g));
  add_child(medium, phase);
}

}  // namespace

void translate_medium(const Translation& t, Object& medium) {
  const std::string plain = plain_name(medium.type);
  if (is_homogeneous(plain)) {
    medium.type = "homogeneous";
    settle_density(t, medium);
    settle_extinction(medium);
    settle_phase(t, medium);
    // One of both alone is all that the medium does.
    if (find(medium, "sigma_s") != nullptr && find_any(medium, {"sigma_t", "albedo"}) == nullptr)
      set_default(medium, "sigma_a", RgbValue{glm::vec3(0.0f)});
    if (find(medium, "sigma_a") != nullptr && find_any(medium, {"sigma_t", "albedo"}) == nullptr)
      set_default(medium, "sigma_s", RgbValue{glm::vec3(0.0f)});
    return;
  }
  t.report.unsupported(
      medium.type_location,
      fmt::format("medium type '{}' is not one of Nori's that Penumbra reads; it reads homogeneous",
                  medium.type),
      "it is left out");
  medium.type.clear();
}

void translate_phase(const Translation&, Object& phase) {
  const std::string plain = plain_name(phase.type);
  if (plain == "henyeygreenstein" || plain == "anisophase" || plain == "henyey") {
    phase.type = "hg";
    set_default(phase, "g", 0.0);
  }
  if (plain == "iso" || plain == "isophase" || plain == "uniform") phase.type = "isotropic";
}

void place_media(const Translation& t, Object& scene) {
  std::vector<Child> media;
  for (const Child& child : scene.children)
    if (child.object->tag == "medium" && !child.object->type.empty()) media.push_back(child);
  std::erase_if(scene.children, [](const Child& child) { return child.object->tag == "medium"; });
  bool fills_everything = false;
  for (const Child& child : media) {
    Object& medium = *child.object;
    if (Object* const shape = shape_of(t, medium)) {
      add_child(*shape, t.new_object("bsdf", "null", medium.location));
      add_child(*shape, medium, "interior");
      add_child(scene, *shape);
    } else if (std::exchange(fills_everything, true)) {
      t.report.warn(medium.location, "the scene has a medium without bounds already; this one is ignored");
    } else if (Child* const view = find_child(scene, "sensor")) {
      add_child(*view->object, medium);
    }
  }
}

}  // namespace penumbra::nori
