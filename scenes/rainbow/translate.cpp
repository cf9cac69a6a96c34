#include "scenes/rainbow/translate.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "scenes/nori/object_edit.h"
#include "scenes/transform.h"

namespace penumbra::rainbow {

using mitsuba::Child;
using mitsuba::Object;
using mitsuba::ObjectTree;
using mitsuba::Parameter;
using mitsuba::RgbValue;
using nori::find;
using nori::number_of;
using nori::rename;
using nori::set;
using nori::set_default;
using nori::take;

namespace {

/// A BSDF of Rainbow with Mitsuba's names; the values are its defaults where Mitsuba's are others.
struct BsdfRow {
  std::string_view rainbow;
  const char* ours;
  std::vector<std::pair<std::string_view, const char*>> parameters;
  std::vector<std::pair<const char*, mitsuba::Value>> defaults;
  bool two_sided;  ///< both of its sides reflect
};
const std::vector<BsdfRow>& rows() {
  const RgbValue copper_eta{glm::vec3(0.200438f, 0.924033f, 1.10221f)};
  const RgbValue copper_k{glm::vec3(3.91295f, 2.45285f, 2.14219f)};
  const std::vector<std::pair<std::string_view, const char*>> glass = {
      {"eta_i", "ext_ior"},
      {"eta_t", "int_ior"},
      {"reflectance", "specular_reflectance"},
      {"transmission", "specular_transmittance"}};
  const std::vector<std::pair<const char*, mitsuba::Value>> glass_defaults = {{"ext_ior", 1.0},
                                                                              {"int_ior", 1.5}};
  static const std::vector<BsdfRow> all = {{"diffuse", "diffuse", {{"albedo", "reflectance"}}, {}, true},
                                           {"matte", "diffuse", {{"albedo", "reflectance"}}, {}, true},
                                           {"mirror",
                                            "conductor",
                                            {{"reflectance", "specular_reflectance"}},
                                            {{"material", std::string("none")}},
                                            true},
                                           {"glass", "dielectric", glass, glass_defaults, false},
                                           {"dielectric", "dielectric", glass, glass_defaults, false},
                                           {"roughconductor",
                                            "roughconductor",
                                            {{"reflectance", "specular_reflectance"}},
                                            {{"eta", copper_eta}, {"k", copper_k}},
                                            true}};
  return all;
}

class Translator {
 public:
  Translator(ObjectTree& tree, ReaderReport& report) : tree_(tree), report_(report) {}

  void translate() {
    const std::size_t given = tree_.objects.size();                  // new ones need no translation
    for (std::size_t i = given; i-- > 0;) unwrap(tree_.objects[i]);  // those inside come later
    for (std::size_t i = 0; i < given; ++i) find_held(tree_.objects[i]);
    for (std::size_t i = 0; i < given; ++i) translate(tree_.objects[i]);
    for (std::size_t i = 0; i < given; ++i)
      if (tree_.objects[i].tag == "sensor") translate_camera(tree_.objects[i]);
  }

 private:
  Object* object_of(const Child& child) const {
    if (child.object != nullptr) return child.object;
    const auto found = tree_.by_id.find(child.reference);
    return found != tree_.by_id.end() ? found->second : nullptr;
  }

  static const BsdfRow* row_of(const Object& bsdf) {
    const auto row = std::ranges::find(rows(), bsdf.type, &BsdfRow::rainbow);
    return row != rows().end() ? &*row : nullptr;
  }

  /// A BSDF of a type that Rainbow does not know is the one inside it.
  void unwrap(Object& bsdf) {
    std::set<const Object*> seen = {&bsdf};
    const auto inside_of = [&](const Object& outside) -> const Object* {
      for (const Child& child : outside.children)
        if (const Object* inside = object_of(child);
            inside != nullptr && inside->tag == "bsdf" && seen.insert(inside).second)
          return inside;
      return nullptr;
    };
    while (bsdf.tag == "bsdf" && row_of(bsdf) == nullptr && bsdf.type != "twosided") {
      const Object* inside = inside_of(bsdf);
      if (inside == nullptr) return;
      report_.warn(bsdf.type_location,
                   fmt::format("bsdf type '{}' is the {} inside it", bsdf.type, inside->type));
      const std::string id = bsdf.id;
      bsdf = Object(*inside);
      bsdf.id = id;
    }
  }

  void find_held(const Object& object) {
    if (object.tag != "bsdf") return;
    for (const Child& child : object.children)
      if (const Object* inside = object_of(child); inside != nullptr && inside->tag == "bsdf")
        held_.insert(inside);
  }

  void translate(Object& object) {
    if (object.tag == "bsdf") translate_bsdf(object);
    if (object.tag == "integrator") translate_integrator(object);
    if (object.tag == "medium") translate_medium(object);
    if (object.tag == "emitter") translate_emitter(object);
    if (object.tag == "shape") take(object, "subdiv");  // as fine as the sphere's triangles would be
  }

  void translate_bsdf(Object& bsdf) {
    const BsdfRow* row = row_of(bsdf);
    if (row == nullptr) return;
    for (const auto& [from, to] : row->parameters) rename(bsdf, {from}, to);
    for (const auto& [name, value] : row->defaults) set_default(bsdf, name, value);
    bsdf.type = row->ours;
    if (bsdf.type == "roughconductor") settle_metal(bsdf);
    if (!row->two_sided || held_.contains(&bsdf)) return;
    Object& inside = tree_.objects.emplace_back(std::move(bsdf));
    bsdf = Object{};
    bsdf.tag = inside.tag;
    bsdf.type = "twosided";
    bsdf.id = std::exchange(inside.id, "");
    bsdf.location = inside.location;
    bsdf.type_location = inside.type_location;
    nori::add_child(bsdf, inside);
  }

  /// Rainbow reads the numbers of a metal, not its name.
  void settle_metal(Object& bsdf) {
    take(bsdf, "ext_eta");
    if (const auto name = take(bsdf, "material"))
      report_.warn(name->location,
                   "Rainbow reads eta and k of a metal, not its name; those of copper are its "
                   "defaults");
  }

  /// By itself it only scatters; its phase function's mean cosine is its own.
  void translate_medium(Object& medium) {
    if (medium.type != "homogeneous") return;
    set_default(medium, "sigma_a", RgbValue{glm::vec3(0.0f)});
    set_default(medium, "sigma_s", RgbValue{glm::vec3(1.0f)});
    auto g = take(medium, "g");
    if (!g) return;
    Object& phase = tree_.new_object("phase", "hg", g->location);
    phase.parameters.push_back(std::move(*g));
    nori::add_child(medium, phase);
  }

  /// A count, of which too many are as many as an image may have.
  static std::int64_t count_of(const Parameter* given, std::int64_t fallback) {
    const double number = given != nullptr ? number_of(*given).value_or(double(fallback)) : double(fallback);
    return std::isnan(number) ? fallback : std::int64_t(std::clamp(number, -1.0, 1e9));
  }

  void translate_integrator(Object& integrator) {
    constexpr std::int64_t kDefaultSamples = 10, kDefaultDepth = 5;
    const auto samples = take(integrator, "sample_num");
    samples_ = count_of(samples ? &*samples : nullptr, kDefaultSamples);
    take(integrator, "delta");  // how often it saves the image
    // It counts the bounces; Mitsuba counts also the light that is seen directly.
    const std::int64_t bounces = count_of(find(integrator, "max_depth"), kDefaultDepth);
    set(integrator, "max_depth", bounces < 0 ? bounces : bounces + 1);
  }

  /// Angles of spots are from the axis; between them the cosine fades out by its fourth power.
  void translate_emitter(Object& emitter) {
    if (emitter.type == "area") {
      const auto scale = take(emitter, "scale");
      const auto factor = scale ? number_of(*scale) : std::nullopt;
      if (!factor) return;
      const Parameter* radiance = find(emitter, "radiance");
      const auto colour = radiance != nullptr ? nori::colour_of(*radiance) : std::optional(glm::vec3(1.0f));
      if (!colour) return report_.error(scale->location, "scale multiplies a radiance that is a colour");
      set(emitter, "radiance", RgbValue{*colour * float(*factor)});
    }
    if (emitter.type != "spot") return;
    const auto angle = [&](std::string_view name, double fallback) {
      const auto given = take(emitter, name);
      return given ? number_of(*given).value_or(fallback) : fallback;
    };
    const double beam = angle("falloff_angle", 45.0);
    set(emitter, "beam_width", beam);
    set(emitter, "cutoff_angle", std::max(angle("total_angle", 90.0), beam));  // within the beam all is light
    set(emitter, "falloff", std::string("squared"));
    report_.warn_counted(emitter.location,
                         "between its angles a spot of Rainbow fades out by the fourth power, and by its "
                         "transform twice; here by the square, where it points");
  }

  /// Its films are mirrored, and its angle is vertical.
  void translate_camera(Object& camera) {
    const Parameter* given = find(camera, "to_world");
    const auto* to_world = given != nullptr ? std::get_if<glm::dmat4>(&given->value) : nullptr;
    set(camera, "to_world",
        (to_world != nullptr ? *to_world : glm::dmat4(1.0)) * scaling(glm::dvec3(-1.0, 1.0, 1.0)));
    set(camera, "fov_axis", std::string("y"));
    set_default(camera, "fov", 30.0);
    const auto sampler = std::ranges::find_if(camera.children, [&](const Child& child) {
      const Object* object = object_of(child);
      return object != nullptr && object->tag == "sampler";
    });
    Object* object = sampler != camera.children.end() ? object_of(*sampler) : nullptr;
    if (object == nullptr) {
      object = &tree_.new_object("sampler", "independent", camera.location);
      nori::add_child(camera, *object);
    }
    set(*object, "sample_count", samples_);
  }

  ObjectTree& tree_;
  ReaderReport& report_;
  std::set<const Object*> held_;  ///< BSDFs inside others
  std::int64_t samples_ = 10;
};

}  // namespace

void translate(ObjectTree& tree, ReaderReport& report) { Translator(tree, report).translate(); }

}  // namespace penumbra::rainbow
