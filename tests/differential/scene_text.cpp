#include "tests/differential/scene_text.h"

#include <stdexcept>

#include "scenes/scene_reader.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/written_scene.h"

namespace penumbra::differential {

void SceneText::write(const std::filesystem::path& folder) const {
  std::filesystem::create_directories(folder);
  if (!converted.empty()) return write_converted(folder);
  write_text(folder / "ours.xml", fmt::format("<scene version=\"{}\">\n{}</scene>\n", version, ours));
  write_text(folder / "mitsuba.xml", fmt::format("<scene version=\"{}\">\n{}</scene>\n", version, mitsubas));
  for (const MeshFile& mesh : meshes) write_text(folder / mesh.name, mesh.text);
}

void SceneText::write_converted(const std::filesystem::path& folder) const {
  for (const MeshFile& mesh : meshes) write_text(folder / mesh.name, mesh.text);
  write_text(folder / converted, ours);
  const auto scene = read_scene(folder / converted, {.settings = settings});
  if (!scene) throw std::runtime_error(scene.error().message);
  if (const auto done = write_scene(*scene, folder / "mitsuba.xml"); !done)
    throw std::runtime_error(done.error().message);
}

std::string number_text(double value) { return fmt::format("{:.7g}", value); }

std::string vector_text(glm::dvec3 value) {
  return fmt::format("{}, {}, {}", number_text(value.x), number_text(value.y), number_text(value.z));
}

std::string element(std::string_view tag, std::string_view name, std::string_view value) {
  return fmt::format("<{} name=\"{}\" value=\"{}\"/>\n", tag, name, value);
}

std::string integer(std::string_view name, int value) {
  return element("integer", name, std::to_string(value));
}
std::string real(std::string_view name, double value) { return element("float", name, number_text(value)); }
std::string text(std::string_view name, std::string_view value) { return element("string", name, value); }
std::string boolean(std::string_view name, bool value) {
  return element("boolean", name, value ? "true" : "false");
}
std::string rgb(std::string_view name, glm::dvec3 value) { return element("rgb", name, vector_text(value)); }

std::string translate(glm::dvec3 offset) {
  return fmt::format("<translate value=\"{}\"/>\n", vector_text(offset));
}

std::string to_world(std::string_view steps) {
  return fmt::format("<transform name=\"to_world\">\n{}</transform>\n", steps);
}

std::string plugin(std::string_view tag, std::string_view type, std::string_view inside) {
  return fmt::format("<{} type=\"{}\">\n{}</{}>\n", tag, type, inside, tag);
}

std::string look_at(glm::dvec3 origin, glm::dvec3 target) {
  return to_world(fmt::format("<lookat origin=\"{}\" target=\"{}\" up=\"0, 1, 0\"/>\n", vector_text(origin),
                              vector_text(target)));
}

}  // namespace penumbra::differential
