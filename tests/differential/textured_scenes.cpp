#include "tests/differential/textured_scenes.h"

#include <cstdint>

#include "tests/differential/scene_parts.h"
#include "tests/support/tga_file.h"

namespace penumbra::differential {
namespace {

/// Few and unlike texels, so that each is seen, and which way round it is.
MeshFile image(const std::string& name, int channels) {
  Random random(7);
  std::vector<std::uint8_t> values;
  for (int i = 0; i < 5 * 4 * channels; ++i) values.push_back(std::uint8_t(random.between(20, 250)));
  return {name, tga_file(5, 4, channels, values)};
}

std::string to_uv(std::string_view steps) {
  return fmt::format("<transform name=\"to_uv\">\n{}</transform>\n", steps);
}

std::string bitmap(const std::string& inside = "", const std::string& file = "image.tga") {
  return fmt::format(
      "<bsdf type=\"twosided\"><bsdf type=\"diffuse\"><texture type=\"bitmap\" name=\"reflectance\">\n{}{}"
      "</texture></bsdf></bsdf>\n",
      text("filename", file), inside);
}

/// Under an even sky, which convex things reflect as they are; seen from the front.
SceneText scene_of(std::string_view name) {
  SceneText scene;
  scene.name = name;
  scene.block = 2;
  scene.meshes = {image("image.tga", 3), image("grey.tga", 1)};
  const std::string film = integer("width", 48) + integer("height", 48) + plugin("rfilter", "box", "");
  scene.both(plugin("integrator", "path", integer("max_depth", 2)) +
             plugin("sensor", "perspective",
                    real("fov", 40) + look_at({0.3, 0.2, 8}, {0, 0, 0}) + plugin("film", "hdrfilm", film)) +
             "<emitter type=\"constant\"><rgb name=\"radiance\" value=\"1, 1, 1\"/></emitter>\n");
  return scene;
}

/// Six pictures side by side, each over more than the unit square.
SceneText edges(const std::string& filter) {
  SceneText scene = scene_of("bitmap-edges-" + filter);
  int at = 0;
  for (const char* wrap : {"repeat", "mirror", "clamp"})
    for (const bool grey : {false, true}) {
      const std::string more =
          "<scale value=\"2.7\"/><rotate z=\"1\" angle=\"25\"/><translate x=\"-0.8\" y=\"-0.6\"/>\n";
      scene.both(placed("rectangle",
                        fmt::format("<translate x=\"{}\" y=\"{}\"/><scale value=\"0.85\"/>\n",
                                    2.3 * (at % 3 - 1), at < 3 ? 1.2 : -1.2),
                        bitmap(text("wrap_mode", wrap) + text("filter_type", filter) +
                                   boolean("raw", at % 3 == 1) + to_uv(more),
                               grey ? "grey.tga" : "image.tga")));
      ++at;
    }
  return scene;
}

/// Every shape, turned about all axes, mirrored or not. Mitsuba loses the coordinates of a sphere that is
/// both.
SceneText turned(bool mirrored) {
  SceneText scene = scene_of(mirrored ? "bitmap-mirrored-shapes" : "bitmap-turned-shapes");
  scene.meshes.push_back({"ball.obj", obj_text(ball(6, 9, 1), true, false, true)});
  scene.meshes.push_back({"bare.obj", obj_text(faceted(ball(3, 5, 1)), true)});
  const std::string inside = bitmap(text("filter_type", "nearest"));
  int at = 0;
  for (const char* type : {"sphere", "disk", "cube", "rectangle", "obj", "obj"}) {
    const int turns = mirrored && at == 0 ? 0 : 1;
    const std::string file =
        at < 4 ? "" : text("filename", at == 4 ? "ball.obj" : "bare.obj") + boolean("face_normals", true);
    scene.both(
        placed(type,
               fmt::format("<scale x=\"{}\"/><rotate x=\"1\" angle=\"{}\"/><rotate y=\"1\" angle=\"{}\"/>"
                           "<rotate z=\"1\" angle=\"{}\"/><scale value=\"0.7\"/><translate x=\"{}\" "
                           "y=\"{}\"/>\n",
                           mirrored ? -1 : 1, turns * (30 + 20 * at), turns * 40, turns * 70,
                           2.2 * (at % 3 - 1), at < 3 ? 1.2 : -1.2),
               file + inside));
    ++at;
  }
  return scene;
}

/// Checkerboards through transforms, and one of bitmaps.
SceneText checkerboards() {
  SceneText scene = scene_of("checkerboards");
  const auto board = [](const std::string& inside) {
    return "<bsdf type=\"diffuse\"><texture type=\"checkerboard\" name=\"reflectance\">" + inside +
           "</texture></bsdf>\n";
  };
  scene.both(
      placed("rectangle", "<translate x=\"-1.2\"/>\n",
             board(rgb("color0", {0.9, 0.2, 0.1}) + rgb("color1", {0.1, 0.2, 0.8}) +
                   to_uv("<scale x=\"3\" y=\"2\"/><rotate z=\"1\" angle=\"20\"/><translate x=\"0.3\"/>\n"))));
  scene.both(
      placed("rectangle", "<translate x=\"1.2\"/>\n",
             board("<texture type=\"bitmap\" name=\"color0\">" + text("filename", "image.tga") +
                   "</texture><texture type=\"bitmap\" name=\"color1\">" + text("filename", "grey.tga") +
                   boolean("raw", true) + to_uv("<scale value=\"2\"/>\n") + "</texture>")));
  return scene;
}

/// Of vertices, and of faces.
SceneText mesh_colours() {
  SceneText scene = scene_of("mesh-colours");
  scene.meshes.push_back(
      {"colours.ply",
       "ply\nformat ascii 1.0\nelement vertex 5\nproperty float x\nproperty float y\nproperty float z\n"
       "property float r\nproperty float g\nproperty float b\nelement face 3\nproperty list uchar int "
       "vertex_indices\nproperty float r\nproperty float g\nproperty float b\nend_header\n"
       "0 0 0 1 0 0\n1 0 0 0 1 0\n1 1 0 0 0 1\n0 1 0 .2 .2 .2\n-.7 .5 0 .9 .8 0\n"
       "3 0 1 2 .1 .5 .9\n3 0 2 3 .9 .5 .1\n3 0 3 4 .3 .9 .3\n"});
  for (const std::string name : {"vertex_color", "face_color"})
    scene.both(placed(
        "ply",
        name[0] == 'v' ? "<translate x=\"-1\" y=\"-1\"/><scale value=\"1.5\"/>\n" : "<translate x=\"1\"/>\n",
        text("filename", "colours.ply") +
            "<bsdf type=\"diffuse\"><texture type=\"mesh_attribute\" name=\"reflectance\">" +
            text("name", name) + "</texture></bsdf>\n"));
  return scene;
}

}  // namespace

std::vector<SceneText> textured_scenes() {
  return {edges("nearest"), edges("bilinear"), turned(false), turned(true), checkerboards(), mesh_colours()};
}

}  // namespace penumbra::differential
