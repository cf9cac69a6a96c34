#include "tests/differential/emitter_scenes.h"

#include <cstdint>

#include "tests/differential/random.h"
#include "tests/differential/scene_parts.h"
#include "tests/support/tga_file.h"

namespace penumbra::differential {
namespace {

/// Unlike texels, so that it is seen which way round they are; few of them bright if it is `sparse`.
MeshFile image(const std::string& name, int width, int height, bool sparse) {
  Random random(11);
  std::vector<std::uint8_t> values;
  for (int i = 0; i < width * height; ++i) {
    const bool dark = sparse && i % 5 != 2;
    for (int c = 0; c < 3; ++c) values.push_back(std::uint8_t(dark ? 3.0 : random.between(40, 250)));
  }
  return {name, tga_file(width, height, 3, values)};
}

std::string bitmap(std::string_view name, std::string_view file) {
  return fmt::format("<texture type=\"bitmap\" name=\"{}\">\n{}{}</texture>\n", name, text("filename", file),
                     text("wrap_mode", "clamp"));
}

/// A floor, a wall and a ball.
SceneText room(std::string_view name, int depth = 3) {
  SceneText scene;
  scene.name = name;
  scene.meshes = {image("image.tga", 6, 4, false), image("sparse.tga", 9, 7, true)};
  const std::string film = integer("width", 36) + integer("height", 36) + plugin("rfilter", "box", "");
  scene.both(plugin("integrator", "path", integer("max_depth", depth)) +
             plugin("sensor", "perspective",
                    real("fov", 45) + look_at({0.4, 1.5, 6}, {0, 0, 0}) + plugin("film", "hdrfilm", film)));
  scene.both(placed("rectangle",
                    "<scale value=\"2.5\"/><rotate x=\"1\" angle=\"-90\"/><translate y=\"-1\"/>\n", kWhite));
  scene.both(placed("rectangle", "<scale value=\"2.5\"/><translate z=\"-2\"/>\n", kWhite));
  scene.both(placed("sphere", "<scale value=\"0.5\"/><translate x=\"0.3\" y=\"-0.5\"/>\n", kWhite));
  return scene;
}

std::string from(glm::dvec3 eye, glm::dvec3 target, std::string_view first = "") {
  return fmt::format(
      "<transform name=\"to_world\">{}<lookat origin=\"{}\" target=\"{}\" up=\"0.1, 1, 0.2\"/></transform>\n",
      first, vector_text(eye), vector_text(target));
}

SceneText spots() {
  SceneText scene = room("spots");
  scene.both(plugin("emitter", "spot",
                    rgb("intensity", {20, 14, 8}) + real("cutoff_angle", 35) + real("beam_width", 12) +
                        from({-1.5, 2.5, 2}, {-0.5, -1, 0})));
  scene.both(plugin("emitter", "spot", rgb("intensity", {6, 9, 15}) + from({1.5, 1.5, 3}, {0.2, -0.4, 0})));
  scene.both(plugin("emitter", "spot",
                    rgb("intensity", {3, 3, 3}) + real("cutoff_angle", 85) + real("beam_width", 0) +
                        from({0, 2, -1}, {0.2, 0, -2})));
  return scene;
}

SceneText textured_spots() {
  SceneText scene = room("textured-spots");
  scene.both(plugin("emitter", "spot",
                    rgb("intensity", {25, 25, 25}) + bitmap("texture", "image.tga") +
                        real("cutoff_angle", 40) + from({-1, 2.5, 3}, {-0.3, -1, -1})));
  scene.both(plugin("emitter", "spot",
                    rgb("intensity", {9, 7, 5}) + bitmap("texture", "sparse.tga") + real("beam_width", 19) +
                        from({2, 1, 3}, {0.5, -0.2, -2}, "<scale x=\"-1\"/>")));
  return scene;
}

SceneText directional() {
  SceneText scene = room("directional");
  scene.both(plugin("emitter", "directional",
                    rgb("irradiance", {2, 1.5, 1}) + "<vector name=\"direction\" value=\"0.4, -2, -1\"/>\n"));
  scene.both(
      plugin("emitter", "directional", rgb("irradiance", {0.3, 0.5, 0.9}) + from({3, 1, 2}, {0, 0, 0})));
  scene.both("<emitter type=\"constant\"><rgb name=\"radiance\" value=\"0.1, 0.2, 0.3\"/></emitter>\n");
  return scene;
}

SceneText projectors() {
  SceneText scene = room("projectors");
  scene.both(plugin("emitter", "projector",
                    bitmap("irradiance", "image.tga") + real("scale", 6) + real("fov", 40) +
                        from({0.5, 2, 4}, {-0.3, -0.5, -1})));
  scene.both(plugin("emitter", "projector",
                    bitmap("irradiance", "sparse.tga") + real("scale", 4) + real("fov", 50) +
                        text("fov_axis", "y") + from({-2, 1, 1}, {0.5, -0.5, -1}, "<scale x=\"-1\"/>")));
  scene.both(
      plugin("emitter", "projector",
             bitmap("irradiance", "sparse.tga") + real("scale", 0.7) + from({2, 2, 0}, {0.8, -1, -0.5})));
  return scene;
}

/// A folded sheet whose texture coordinates fill the unit square once: Mitsuba samples the texture, and looks
/// for the mesh's point of those coordinates.
std::string sheet() {
  std::string obj;
  for (int j = 0; j <= 2; ++j)
    for (int i = 0; i <= 3; ++i)
      obj += fmt::format("v {} {} {}\nvt {} {}\n", 0.7 * i - 1, j - 0.9 + 0.1 * i, 0.3 * ((i + 2 * j) % 3),
                         i / 3.0, j / 2.0);
  const auto face = [&](int a, int b, int c) { obj += fmt::format("f {0}/{0} {1}/{1} {2}/{2}\n", a, b, c); };
  for (int j = 0; j < 2; ++j)
    for (int i = 1; i <= 3; ++i) {
      const int at = 4 * j + i;
      face(at, at + 1, at + 5);
      face(at, at + 5, at + 4);
    }
  return obj;
}

/// A light of that shape with that image, which is seen too.
SceneText textured_light(std::string_view shape, std::string_view file) {
  SceneText scene = room(fmt::format("textured-{}-{}", shape, file.substr(0, file.find('.'))));
  scene.samples = 2;
  const std::string light =
      plugin("emitter", "area", bitmap("radiance", file)) + "<bsdf type=\"diffuse\"/>\n";
  std::string more;
  if (shape == "obj") {
    scene.meshes.push_back({"sheet.obj", sheet()});
    more = text("filename", "sheet.obj") + boolean("face_normals", true);
  }
  scene.both(placed(shape,
                    "<scale value=\"0.9\"/><rotate z=\"1\" angle=\"20\"/><rotate x=\"1\" "
                    "angle=\"70\"/><translate x=\"-0.7\" y=\"0.9\" z=\"0.3\"/>\n",
                    more + light));
  return scene;
}

}  // namespace

std::vector<SceneText> emitter_scenes() {
  std::vector<SceneText> scenes = {spots(), textured_spots(), directional(), projectors()};
  for (const char* shape : {"rectangle", "disk", "sphere", "obj"})
    for (const char* file : {"image.tga", "sparse.tga"}) scenes.push_back(textured_light(shape, file));
  return scenes;
}

}  // namespace penumbra::differential
