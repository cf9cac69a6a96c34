#include "scenes/nori/test_scenes.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <string_view>

#include "scenes/number.h"
#include "scenes/transform.h"

namespace penumbra::nori {

using mitsuba::ElementReader;
using mitsuba::Object;
using mitsuba::RgbValue;

namespace {

/// The numbers of <string name="…" value="1, 2, 3"/>.
std::vector<double> numbers_of(const ElementReader& test, std::string_view name) {
  for (const pugi::xml_node& child : test.element().children("string")) {
    if (name != child.attribute("name").value()) continue;
    const auto numbers = parse_numbers(child.attribute("value").value());
    if (numbers) return *numbers;
    test.child(child).wrong_value("value", numbers.error().message);
  }
  return {};
}

}  // namespace

std::optional<TestScene> choose_test_scene(const ElementReader& test, std::optional<int> number,
                                           ReaderReport& report) {
  std::vector<TestScene> scenes;
  for (const pugi::xml_node& scene : test.element().children("scene")) scenes.push_back({scene});
  const std::vector<double> references = numbers_of(test, "references");
  std::vector<double> angles = numbers_of(test, "angles");
  if (angles.empty()) angles.push_back(0.0);
  for (const pugi::xml_node& bsdf : test.element().children("bsdf"))
    for (const double angle : angles) scenes.push_back({bsdf, angle});
  if (scenes.empty())
    return test.wrong("the <test> has no <scene> and no <bsdf>, so there is nothing to render"), std::nullopt;
  const int chosen = number.value_or(1);
  if (chosen < 1 || std::size_t(chosen) > scenes.size())
    return test.wrong(fmt::format("there is no scene {} in the <test>, which has {}", chosen, scenes.size())),
           std::nullopt;
  TestScene& scene = scenes[std::size_t(chosen) - 1];
  scene.number = std::size_t(chosen);
  scene.count = scenes.size();
  for (const pugi::xml_node& child : test.element().children("integer"))
    if (std::string_view(child.attribute("name").value()) == "sampleCount")
      if (const auto samples = parse_integer(child.attribute("value").value()); samples && *samples > 0)
        scene.samples = *samples;
  if (references.size() == scenes.size()) scene.reference = references[scene.number - 1];
  if (references.size() == 1) scene.reference = references.front();
  std::string text = scenes.size() > 1
                         ? fmt::format("scene {} of the {} of a <test> is rendered", chosen, scenes.size())
                         : std::string("the scene of a <test> is rendered");
  if (scene.angle)
    text += fmt::format(", a plane of its BSDF in light of radiance 1, at {} degrees", *scene.angle);
  if (scene.reference) text += fmt::format("; its mean should be {}", *scene.reference);
  if (scenes.size() > 1) text += "; -D scene=N chooses another";
  report.warn(test.location(), text);
  return scene;
}

void settle_test_camera(const Translation& t, Object& scene, std::int64_t samples) {
  mitsuba::Child* const camera = find_child(scene, "sensor");
  if (camera == nullptr) return;
  Object& view = *camera->object;
  if (find_child(view, "sampler") == nullptr)
    add_child(view, t.new_object("sampler", "independent", view.location));
  set(*find_child(view, "sampler")->object, "sample_count", samples);
  Object& film = *find_child(view, "film")->object;
  std::erase_if(film.children, [](const mitsuba::Child& c) { return c.object->tag == "rfilter"; });
  add_child(film, t.new_object("rfilter", "box", view.location));
}

void build_bsdf_scene(const Translation& t, Object& scene, Object& bsdf, double angle) {
  const SourceLocation place = bsdf.location;
  Object& plane = t.new_object("shape", "rectangle", place);
  add_child(plane, bsdf);
  Object& light = t.new_object("emitter", "constant", place);
  set(light, "radiance", RgbValue{glm::vec3(1.0f)});
  Object& camera = t.new_object("sensor", "perspective", place);
  const double radians = angle * std::numbers::pi / 180;
  const glm::dvec3 origin(std::sin(radians), 0.0, std::cos(radians));
  if (const auto frame = look_at(origin, glm::dvec3(0.0), std::nullopt)) set(camera, "to_world", *frame);
  set(camera, "fov", 1e-3);
  Object& film = t.new_object("film", "hdrfilm", place);
  set(film, "width", std::int64_t(1));
  set(film, "height", std::int64_t(1));
  add_child(camera, film);
  Object& integrator = t.new_object("integrator", "path_mis", place);
  for (Object* each : {&plane, &light, &camera, &integrator}) add_child(scene, *each);
}

}  // namespace penumbra::nori
