#include "scenes/nori/nori_tree.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <numbers>
#include <optional>
#include <pugixml.hpp>

#include "scenes/mitsuba/value_reader.h"
#include "scenes/mitsuba/xml_source.h"
#include "scenes/names.h"
#include "scenes/number.h"

namespace penumbra::nori {
namespace {

using mitsuba::Child;
using mitsuba::ElementReader;
using mitsuba::Object;
using mitsuba::ObjectTree;
using mitsuba::Parameter;
using mitsuba::RgbValue;
using mitsuba::Value;

/// Nori's elements that are objects, and what they are called in Mitsuba.
struct Tag {
  const char *nori, *mitsuba;
};
constexpr Tag kTags[] = {
    {"mesh", "shape"},      {"shape", "shape"},       {"camera", "sensor"},         {"bsdf", "bsdf"},
    {"emitter", "emitter"}, {"luminaire", "emitter"}, {"integrator", "integrator"}, {"sampler", "sampler"},
    {"rfilter", "rfilter"}, {"medium", "medium"},     {"phase", "phase"},           {"texture", "texture"},
    {"test", "test"}};

/// Integrators, and the settings of ours that make the same image.
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
      {"whitted", "whitted", {{"indirect_samples", I(0)}}},
      // What leaves the scene is black in the one and white in the other.
      {"ao", "ao", {{"ray_length", 0.0}, {"background", 0.0}}},
      {"av",
       "ao",
       {{"occlusion_sampling", std::string("hemisphere")},
        {"occlusion_weighting", std::string("uniform")},
        {"background", 1.0}}}};
  return all;
}

std::string text_of(const Value& value) {
  if (const auto* number = std::get_if<double>(&value)) return fmt::format("{}", *number);
  if (const auto* whole = std::get_if<std::int64_t>(&value)) return fmt::format("{}", *whole);
  if (const auto* text = std::get_if<std::string>(&value)) return *text;
  return "";
}

/// Whether the tag of a value is that of a number or text with which settings are given.
const char* tag_of(const Value& value) {
  return std::holds_alternative<std::int64_t>(value) ? "integer"
         : std::holds_alternative<double>(value)     ? "float"
                                                     : "string";
}

class TreeReader {
 public:
  TreeReader(const FileAccess& files, Diagnostics& diagnostics, ReaderReport& report)
      : files_(files), diagnostics_(diagnostics), report_(report) {}

  ObjectTree read(const std::filesystem::path& file) {
    tree_.scene.tag = "scene";
    tree_.folders.push_back(file.parent_path());
    tree_.faceted_without_normals = true;
    tree_.is_tolerant = true;
    auto source = files_.read(file, kMaxSceneFileBytes);
    if (!source) {
      diagnostics_.error({}, source.error().message);
      return std::move(tree_);
    }
    tree_.files.push_back(std::move(*source));
    const SourceFile& text = *tree_.files.back();
    tree_.scene.location = {&text, 0};
    pugi::xml_document document;
    if (const auto parsed = mitsuba::parse_xml(text, document); !parsed) {
      diagnostics_.error_text(parsed.error().message);
      return std::move(tree_);
    }
    const ElementReader root(text, document.document_element(), substitute_, diagnostics_);
    root.check_attributes({});
    for (const pugi::xml_node& each : root.element().children())
      if (each.type() == pugi::node_element && !diagnostics_.full()) read_into(tree_.scene, root.child(each));
    finish_scene();
    return std::move(tree_);
  }

 private:
  void read_into(Object& parent, const ElementReader& element) {
    const std::string_view tag = element.element().name();
    const auto object = std::ranges::find(kTags, tag, &Tag::nori);
    if (tag == "color") return read_colour(parent, element);
    if (object == std::end(kTags)) {
      if (mitsuba::is_value(element.element())) return add(parent, mitsuba::read_value(element));
      std::vector<std::string> known;
      for (const Tag& each : kTags) known.emplace_back(each.nori);
      known.emplace_back("color");
      known.insert(known.end(), mitsuba::value_tags().begin(), mitsuba::value_tags().end());
      element.wrong(fmt::format("<{}> is not an element of a Nori scene{}", tag, suggestion(tag, known)));
      return;
    }
    if (tag == "test") return report_.warn(element.location(), "<test> asks for no image; it is ignored");
    read_object(parent, element, object->mitsuba);
  }

  void read_colour(Object& parent, const ElementReader& element) {
    if (!element.check_attributes({"name", "value"})) return;
    const auto name = element.required("name"), text = element.required("value");
    if (!name || !text) return;
    const auto numbers = parse_numbers(*text);
    if (!numbers || numbers->size() != 3) {
      element.wrong_value("value", numbers ? fmt::format("a color has three numbers, not {}", numbers->size())
                                           : numbers.error().message);
      return;
    }
    const glm::vec3 colour((*numbers)[0], (*numbers)[1], (*numbers)[2]);
    add(parent, Parameter{to_snake_case(*name), "rgb", RgbValue{colour}, *text, element.location(),
                          element.value_location("value")});
  }

  void add(Object& parent, std::optional<Parameter> parameter) {
    if (!parameter) return;
    if (Parameter* same = find(parent, parameter->name)) {
      diagnostics_.warn_counted(parameter->location,
                                fmt::format("the property '{}' is there twice; the last counts", parameter->name));
      *same = std::move(*parameter);
      return;
    }
    parent.parameters.push_back(std::move(*parameter));
  }

  void read_object(Object& parent, const ElementReader& element, const char* tag) {
    element.check_attributes({"type", "name", "id"});
    Object& object = new_object(tag, "", element.location());
    object.type = to_snake_case(element.attribute("type").value_or(""));
    object.type_location = element.value_location("type");
    if (object.type.empty()) element.required("type");
    for (const pugi::xml_node& each : element.element().children())
      if (each.type() == pugi::node_element) read_into(object, element.child(each));
    translate(object);
    add_child(parent, object);
  }

  Object& new_object(const char* tag, const char* type, SourceLocation location) {
    Object& object = tree_.objects.emplace_back();
    object.tag = tag;
    object.type = type;
    object.location = object.type_location = location;
    return object;
  }
  static void add_child(Object& parent, Object& object) {
    parent.children.push_back({"", &object, "", object.location});
  }

  static Parameter* find(Object& object, std::string_view name) {
    const auto found = std::ranges::find(object.parameters, name, &Parameter::name);
    return found == object.parameters.end() ? nullptr : &*found;
  }
  static void rename(Object& object, std::string_view from, const char* to) {
    if (Parameter* parameter = find(object, from)) parameter->name = to;
  }
  /// Sets what is not given.
  static void set_default(Object& object, const char* name, Value value) {
    if (find(object, name) != nullptr) return;
    Parameter parameter{name, tag_of(value), value, text_of(value), object.location, object.location};
    object.parameters.push_back(std::move(parameter));
  }
  std::optional<Parameter> take(Object& object, std::string_view name) {
    const auto found = std::ranges::find(object.parameters, name, &Parameter::name);
    if (found == object.parameters.end()) return std::nullopt;
    Parameter result = std::move(*found);
    object.parameters.erase(found);
    return result;
  }

  void translate(Object& object) {
    if (object.tag == "shape") translate_shape(object);
    if (object.tag == "bsdf") translate_bsdf(object);
    if (object.tag == "emitter") translate_emitter(object);
    if (object.tag == "sensor") translate_camera(object);
    if (object.tag == "integrator") translate_integrator(object);
    if (object.tag == "medium")
      report_.unsupported(
          object.type_location,
          fmt::format("medium type '{}' is not one of Nori's that Penumbra reads", object.type),
          "it is left out");
    if (object.tag == "sampler") set_default(object, "sample_count", std::int64_t(1));
    if (object.tag == "rfilter" && object.type == "gaussian") {
      const auto radius = take(object, "radius");
      Parameter* stddev = find(object, "stddev");
      const double cut =
          radius && std::holds_alternative<double>(radius->value) ? std::get<double>(radius->value) : 2.0;
      const double width = stddev != nullptr && std::holds_alternative<double>(stddev->value)
                               ? std::get<double>(stddev->value)
                               : 0.5;
      if (cut != 4.0 * width)
        report_.warn(object.location,
                     fmt::format("the filter ends at 4 stddev, {} pixels, not at {}", 4.0 * width, cut));
    }
    if (object.tag == "rfilter" && object.type == "mitchell") {
      if (const auto radius = take(object, "radius"); radius && radius->text != "2")
        report_.warn(radius->location, "the radius of a Mitchell filter is 2");
    }
  }

  void translate_shape(Object& object) {
    const bool has_bsdf =
        std::ranges::any_of(object.children, [](const Child& c) { return c.object->tag == "bsdf"; });
    // A lamp's surface too is diffuse in Nori, where nothing is said.
    if (!has_bsdf) add_child(object, new_object("bsdf", "diffuse", object.location));
  }

  void translate_bsdf(Object& object) {
    if (object.type == "diffuse") rename(object, "albedo", "reflectance");
    if (object.type == "mirror") object.type = "conductor";
  }

  void translate_emitter(Object& object) {
    if (object.type == "point") {
      if (Parameter* power = find(object, "power")) {
        power->name = "intensity";
        if (auto* colour = std::get_if<RgbValue>(&power->value))
          colour->rgb *= float(0.25 / std::numbers::pi);
        if (auto* number = std::get_if<double>(&power->value)) *number *= 0.25 / std::numbers::pi;
      }
    }
    if (object.type == "envmap")
      report_.warn_counted(object.location,
                        "envmap is none of Nori's own; it is read with the longitudes of Mitsuba's");
  }

  /// Nori's camera is Mitsuba's sensor: +x is to the left of the image, and lookat means the same.
  void translate_camera(Object& object) {
    set_default(object, "fov", 30.0);
    set_default(object, "fov_axis", std::string("x"));
    set_default(object, "near_clip", 1e-4);
    set_default(object, "far_clip", 1e4);
    set_default(object, "width", std::int64_t(1280));
    set_default(object, "height", std::int64_t(720));
    Object& film = new_object("film", "hdrfilm", object.location);
    for (const char* side : {"width", "height"}) film.parameters.push_back(*take(object, side));
    const auto filter =
        std::ranges::find_if(object.children, [](const Child& c) { return c.object->tag == "rfilter"; });
    if (filter != object.children.end()) {
      film.children.push_back(*filter);
      object.children.erase(filter);
    }
    add_child(object, film);
  }

  void translate_integrator(Object& object) {
    const auto& known = integrators();
    const auto found =
        std::ranges::find_if(known, [&](const Integrator& each) { return object.type == each.nori; });
    if (found == known.end()) {
      std::vector<std::string> names;
      for (const Integrator& each : known) names.emplace_back(each.nori);
      report_.unsupported(object.type_location,
                          fmt::format("integrator type '{}' is not one of Nori's that Penumbra reads{}",
                                      object.type, known_names(object.type, names, "It reads")),
                          "path_mis stands in for it");
      object.type = "path_mis";
      object.parameters.clear();
      return;
    }
    object.type = found->ours;
    rename(object, "length", "ray_length");
    for (const auto& [name, value] : found->settings) set_default(object, name, value);
  }

  /// The sampler belongs to the camera.
  void finish_scene() {
    auto& children = tree_.scene.children;
    const auto of = [&](std::string_view tag) {
      return std::ranges::find_if(children, [&](const Child& c) { return c.object->tag == tag; });
    };
    const auto sampler = of("sampler");
    const auto camera = of("sensor");
    if (camera == children.end()) {
      if (!diagnostics_.failed()) diagnostics_.error(tree_.scene.location, "the scene has no <camera>");
      return;
    }
    if (sampler == children.end()) return;
    Object& object = *sampler->object;
    Object& view = *camera->object;
    children.erase(sampler);
    add_child(view, object);
    if (of("sampler") != children.end())
      diagnostics_.error(of("sampler")->location, "the scene has a second <sampler>");
  }

  const FileAccess& files_;
  Diagnostics& diagnostics_;
  ReaderReport& report_;
  const ElementReader::Substitute substitute_ = [](std::string_view text, SourceLocation) {
    return std::optional<std::string>(text);
  };
  ObjectTree tree_;
};

}  // namespace

ObjectTree read_tree(const std::filesystem::path& file, const FileAccess& files, Diagnostics& diagnostics,
                     ReaderReport& report) {
  return TreeReader(files, diagnostics, report).read(file);
}

}  // namespace penumbra::nori
