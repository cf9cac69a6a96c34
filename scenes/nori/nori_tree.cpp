#include "scenes/nori/nori_tree.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <pugixml.hpp>
#include <utility>
#include <vector>

#include "scenes/mitsuba/value_reader.h"
#include "scenes/mitsuba/xml_source.h"
#include "scenes/names.h"
#include "scenes/nori/test_scenes.h"
#include "scenes/nori/translate.h"
#include "scenes/number.h"

namespace penumbra::nori {
namespace {

using mitsuba::Child;
using mitsuba::ElementReader;
using mitsuba::Object;
using mitsuba::Parameter;
using mitsuba::RgbValue;

/// Nori's elements that are objects, with their names in Mitsuba.
struct Tag {
  const char *nori, *mitsuba;
};
constexpr Tag kTags[] = {
    {"mesh", "shape"},      {"shape", "shape"},       {"camera", "sensor"},         {"bsdf", "bsdf"},
    {"emitter", "emitter"}, {"luminaire", "emitter"}, {"integrator", "integrator"}, {"sampler", "sampler"},
    {"rfilter", "rfilter"}, {"medium", "medium"},     {"phase", "phase"},           {"texture", "texture"},
    {"envmap", "emitter"},  {"volume", "medium"},     {"subscene", "shape"},        {"instance", "shape"}};

/// <diffusemap>, <normaltexture>: the name of the parameter to which the texture belongs; empty for other
/// elements.
std::string map_element(std::string_view tag) {
  const std::string plain = plain_name(tag);
  for (const std::string_view suffix : {"map", "texture"})
    if (plain.size() > suffix.size() && plain.ends_with(suffix)) {
      std::string name = plain.substr(0, plain.size() - suffix.size());
      return name == "diffuse" || name == "color" ? "albedo" : name;
    }
  return "";
}

class TreeReader {
 public:
  TreeReader(const TreeOptions& options, const FileAccess& files, Diagnostics& diagnostics,
             ReaderReport& report)
      : options_(options), files_(files), diagnostics_(diagnostics), report_(report) {}

  Tree read(const std::filesystem::path& file) {
    tree_.scene.tag = "scene";
    tree_.folders.push_back(file.parent_path());
    tree_.faceted_without_normals = true;
    tree_.is_tolerant = true;
    auto source = files_.read(file, kMaxSceneFileBytes);
    if (!source) {
      diagnostics_.error({}, source.error().message);
      return result();
    }
    tree_.files.push_back(std::move(*source));
    const SourceFile& text = *tree_.files.back();
    tree_.scene.location = {&text, 0};
    pugi::xml_document document;
    if (const auto parsed = mitsuba::parse_xml(text, document); !parsed) {
      diagnostics_.error_text(parsed.error().message);
      return result();
    }
    choice_ = dialect_of(document.document_element());
    if (options_.dialect) choice_ = {*options_.dialect, "by --dialect"};
    t_.dialect = choice_.dialect;
    const ElementReader root(text, document.document_element(), substitute_, diagnostics_);
    root.check_attributes({"type", "name", "id", "version"});
    if (std::string_view(root.element().name()) == "test")
      read_test(root);
    else
      read_scene(root);
    return result();
  }

 private:
  Tree result() { return {std::move(tree_), choice_}; }

  void read_scene(const ElementReader& scene) {
    read_children(tree_.scene, scene);
    finish_scene();
  }

  void read_test(const ElementReader& root) {
    const auto chosen = choose_test_scene(root, options_.test_scene, report_);
    if (!chosen) return;
    const ElementReader element = root.child(chosen->element);
    if (!chosen->angle) {
      read_scene(element);
    } else {
      Object holder;
      read_into(holder, element);
      if (holder.children.empty()) return;
      build_bsdf_scene(t_, tree_.scene, *holder.children.front().object, *chosen->angle);
    }
    settle_test_camera(t_, tree_.scene, chosen->samples);
  }

  void read_children(Object& parent, const ElementReader& element) {
    for (const pugi::xml_node& each : element.element().children())
      if (each.type() == pugi::node_element && !diagnostics_.full()) read_into(parent, element.child(each));
  }

  void read_into(Object& parent, const ElementReader& element) {
    const std::string_view tag = element.element().name();
    if (tag == "color") return read_colour(parent, element);
    if (tag == "point" || tag == "vector")
      if (element.element().attribute("value")) return read_vector(parent, element);
    const auto object = std::ranges::find(kTags, tag, &Tag::nori);
    if (object != std::end(kTags)) return read_object(parent, element, object->mitsuba);
    if (mitsuba::is_value(element.element())) return add(parent, mitsuba::read_value(element));
    if (const std::string name = map_element(tag); !name.empty()) return read_map(parent, element, name);
    if (tag == "test") return report_.warn(element.location(), "<test> asks for no image; it is ignored");
    if (tag == "denoiser") return report_.warn(element.location(), "the image is not denoised");
    std::vector<std::string> known;
    for (const Tag& each : kTags) known.emplace_back(each.nori);
    known.emplace_back("color");
    known.insert(known.end(), mitsuba::value_tags().begin(), mitsuba::value_tags().end());
    report_.unsupported(element.location(),
                        fmt::format("<{}> is not an element of a Nori scene{}", tag, suggestion(tag, known)),
                        "it is left out");
  }

  /// The numbers of an element's value. Nothing, and an error, if their count is not between `fewest` and
  /// `most`.
  std::optional<std::vector<double>> read_numbers(const ElementReader& element, std::size_t fewest,
                                                  std::size_t most, std::string_view what) {
    const auto text = element.required("value");
    if (!text) return std::nullopt;
    const auto numbers = parse_numbers(*text);
    if (numbers && numbers->size() >= fewest && numbers->size() <= most) return *numbers;
    element.wrong_value("value", numbers ? fmt::format("a {} has {}three numbers, not {}", what,
                                                       fewest < most ? "two or " : "", numbers->size())
                                         : numbers.error().message);
    return std::nullopt;
  }

  void read_colour(Object& parent, const ElementReader& element) {
    if (!element.check_attributes({"name", "value"})) return;
    const auto name = element.required("name");
    const auto numbers = read_numbers(element, 3, 3, "color");
    if (!name || !numbers) return;
    const glm::vec3 colour((*numbers)[0], (*numbers)[1], (*numbers)[2]);
    add(parent, Parameter{to_snake_case(*name), "rgb", RgbValue{colour}, *element.attribute("value"),
                          element.location(), element.value_location("value")});
  }

  /// Vectors in textures have two numbers.
  void read_vector(Object& parent, const ElementReader& element) {
    if (!element.check_attributes({"name", "value"})) return;
    const auto name = element.required("name");
    const auto numbers = read_numbers(element, 2, 3, element.element().name());
    if (!name || !numbers) return;
    const glm::dvec3 vector((*numbers)[0], (*numbers)[1], numbers->size() > 2 ? (*numbers)[2] : 0.0);
    add(parent, Parameter{to_snake_case(*name), element.element().name(), vector, *element.attribute("value"),
                          element.location(), element.value_location("value")});
  }

  void add(Object& parent, std::optional<Parameter> parameter) {
    if (!parameter) return;
    if (Parameter* same = find(parent, parameter->name)) {
      diagnostics_.warn_counted(
          parameter->location,
          fmt::format("the property '{}' is there twice; the last counts", parameter->name));
      *same = std::move(*parameter);
      return;
    }
    parent.parameters.push_back(std::move(*parameter));
  }

  /// An element of a fork that is a texture: it contains a string with the file name, or names the file
  /// itself.
  void read_map(Object& parent, const ElementReader& element, const std::string& name) {
    Object& texture = t_.new_object("texture", "", element.location());
    texture.type = to_snake_case(element.attribute("type").value_or(element.element().name()));
    texture.type_location = element.value_location("type");
    for (const char* attribute : {"value", "filename", "file"})
      if (const auto file = element.attribute(attribute)) set(texture, "filename", *file);
    read_children(texture, element);
    translate_texture(t_, texture);
    add_child(parent, texture, name);
  }

  void read_object(Object& parent, const ElementReader& element, const char* tag) {
    element.check_attributes({"type", "name", "id"});
    Object& object = t_.new_object(tag, "", element.location());
    object.type = to_snake_case(element.attribute("type").value_or(""));
    object.type_location = element.value_location("type");
    if (object.type.empty()) element.required("type");
    read_children(object, element);
    translate(object, parent);
    if (object.tag == "shape" && !is_seen(object)) return;
    const std::string name = to_snake_case(element.attribute("name").value_or(""));
    add_child(parent, object, object.tag == "texture" ? name : "");
  }

  void translate(Object& object, const Object& parent) {
    if (object.tag == "shape") translate_shape(object);
    if (object.tag == "texture") translate_texture(t_, object);
    if (object.tag == "bsdf") translate_bsdf(t_, object);
    if (object.tag == "emitter") translate_emitter(t_, object, parent.tag == "shape" ? &parent : nullptr);
    if (object.tag == "sensor") translate_camera(t_, object);
    if (object.tag == "integrator") translate_integrator(t_, object);
    if (object.tag == "medium") translate_medium(t_, object);
    if (object.tag == "phase") translate_phase(t_, object);
    if (object.tag == "sampler") translate_sampler(t_, object);
    if (object.tag == "rfilter") translate_filter(t_, object);
  }

  void translate_shape(Object& object) {
    if (is_placed(object)) return;
    if (object.type == "parallelogram") translate_parallelogram(t_, object);
    std::erase_if(object.children,
                  [](const Child& c) { return c.object->tag == "medium" && c.object->type.empty(); });
    bool has_medium = false;
    for (Child& child : object.children)
      if (child.object->tag == "medium") {
        child.name = "interior";
        has_medium = true;
      }
    // In Nori, a shape without a BSDF is diffuse, even if it is an emitter. A shape that bounds a medium is
    // transparent.
    if (find_child(object, "bsdf") == nullptr)
      add_child(object, t_.new_object("bsdf", has_medium ? "null" : "diffuse", object.location));
    bend_bsdf_of(t_, object);
  }

  /// Whether the object is a group of shapes or an instance of one; these have no BSDF. In one fork
  /// (Arnibjarnst's) a <subscene> has a number by which an <instance> names it, in others an instance holds
  /// its shapes.
  bool is_placed(Object& object) {
    if (object.type == "subscene") {
      object.type = "shapegroup";
      const auto id = take(object, "id");
      const auto number = id ? number_of(*id) : std::nullopt;
      if (!number)
        report_.error(object.location, "a <subscene> needs an <integer name=\"id\" …>");
      else if (!subscenes_.try_emplace(*number, &object).second)
        report_.error(id->location, fmt::format("there is a <subscene> of id {} already", id->text));
      return true;
    }
    if (object.type != "instance") return false;
    if (auto named = take(object, "subscene")) {
      instances_.emplace_back(&object, std::move(*named));
    } else if (find_child(object, "shape") != nullptr) {
      Object& group = t_.new_object("shape", "shapegroup", object.location);
      for (Child& child : object.children)
        if (child.object->tag == "shape") group.children.push_back(child);
      std::erase_if(object.children, [](const Child& child) { return child.object->tag == "shape"; });
      add_child(object, group);
    } else {
      report_.error(
          object.location,
          "an instance needs a <shape>, or an <integer name=\"subscene\" …>, the id of a <subscene>");
    }
    return true;
  }

  void resolve_instances() {
    for (const auto& [object, named] : instances_) {
      const auto number = number_of(named);
      const auto found = number ? subscenes_.find(*number) : subscenes_.end();
      if (found != subscenes_.end())
        add_child(*object, *found->second);
      else
        report_.error(named.location, fmt::format("there is no <subscene> of id {}", named.text));
    }
  }

  /// A sphere around the scene that holds its environment map is not a shape in Mitsuba or here.
  bool is_seen(Object& shape) {
    const Child* emitter = find_child(shape, "emitter");
    if (emitter == nullptr || !is_environment(*emitter->object)) return true;
    report_.warn(shape.location,
                 "the shape of an environment is left out; its light comes from beyond the scene");
    add_child(tree_.scene, *emitter->object);
    return false;
  }

  /// The sampler, and media without bounds, belong to the camera.
  void finish_scene() {
    resolve_instances();
    auto& children = tree_.scene.children;
    const auto of = [&](std::string_view tag) {
      return std::ranges::find_if(children, [&](const Child& c) { return c.object->tag == tag; });
    };
    const auto camera = of("sensor");
    if (camera == children.end()) {
      if (!diagnostics_.failed()) diagnostics_.error(tree_.scene.location, "the scene has no <camera>");
      return;
    }
    apply_integrator(t_, tree_.scene);
    place_media(t_, tree_.scene);
    Object& view = *of("sensor")->object;
    const auto sampler = of("sampler");
    if (sampler == children.end()) return;
    Object& object = *sampler->object;
    children.erase(sampler);
    add_child(view, object);
    if (of("sampler") != children.end())
      diagnostics_.error(of("sampler")->location, "the scene has a second <sampler>");
  }

  const TreeOptions& options_;
  const FileAccess& files_;
  Diagnostics& diagnostics_;
  ReaderReport& report_;
  const ElementReader::Substitute substitute_ = [](std::string_view text, SourceLocation) {
    return std::optional<std::string>(text);
  };
  mitsuba::ObjectTree tree_;
  DialectChoice choice_;
  Translation t_{tree_, report_, Dialect::kNori};
  std::map<double, Object*> subscenes_;                   ///< by their ids
  std::vector<std::pair<Object*, Parameter>> instances_;  ///< with the ids of their subscenes
};

}  // namespace

Tree read_tree(const std::filesystem::path& file, const TreeOptions& options, const FileAccess& files,
               Diagnostics& diagnostics, ReaderReport& report) {
  return TreeReader(options, files, diagnostics, report).read(file);
}

}  // namespace penumbra::nori
