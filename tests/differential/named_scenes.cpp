#include "tests/differential/named_scenes.h"

#include <cmath>
#include <string_view>
#include <utility>
#include <vector>

#include "scenes/spectrum.h"
#include "tests/differential/scene_parts.h"
#include "tests/scenes/sdf_writer.h"

namespace penumbra::differential {
namespace {

/// A light that says nothing of its BSDF reflects nothing.
SceneText area_light_without_bsdf() {
  SceneText scene = begin("area-light-without-bsdf", path(3));
  scene.both(placed("sphere", "<scale value=\"0.8\"/>", area(0.3)) + floor_at(-1) + ceiling_area_light());
  return scene;
}

/// Where the shading normal of a smooth mesh looks away while its face does not, and the other way round.
SceneText smooth_rim() {
  SceneText scene = begin("smooth-rim", path(2), {0, 0.5, 5}, 26);
  scene.meshes.push_back({"ball.obj", obj_text(ball(4, 6, 1), true)});
  scene.each(plugin("shape", "obj", text("filename", "ball.obj") + kWhite),
             plugin("shape", "obj", text("filename", "ball.obj") + sides(kWhite)));
  scene.both(kSky);
  return scene;
}

SceneText smooth_rim_one_sided() {
  SceneText scene = begin("smooth-rim-one-sided", path(3), {0, 0.5, 5}, 26);
  Random random(2);
  scene.meshes.push_back({"ball.ply", ply_text(ball(4, 6, 1), true, random)});
  scene.each(plugin("shape", "ply", text("filename", "ball.ply") + kGrey),
             plugin("shape", "ply", text("filename", "ball.ply") + sides(kGrey)));
  scene.both(floor_at(-1.2) +
             placed("rectangle",
                    "<scale value=\"0.6\"/><rotate y=\"1\" angle=\"90\"/><translate x=\"-2\"/>\n",
                    kGrey + area(8)));
  return scene;
}

/// Curves, whose ends are points here.
SceneText curves(std::string_view name, std::string_view type) {
  SceneText scene = begin(name, path(3), {0, 0.5, 5}, 34);
  Random random(31);
  std::string points;
  for (int curve = 0; curve < 6; ++curve) {
    for (int i = 0; i < 11; ++i) {
      const double x = -1.4 + 0.5 * curve + random.between(-0.2, 0.2), z = random.between(-0.3, 0.3);
      const double radius = i < 3 || i > 7 ? 0 : random.between(0.08, 0.16);
      points += fmt::format("{} {} {} {}\n", x, -1.6 + 0.3 * i, z, radius);
    }
    points += "\n";
  }
  scene.meshes.push_back({"curves.txt", points});
  scene.both(plugin("shape", type,
                    text("filename", "curves.txt") +
                        to_world("<scale x=\"1.1\" y=\"0.9\"/><rotate z=\"1\" "
                                 "angle=\"8\"/>\n") +
                        kWhite));
  scene.both(floor_at(-1.2) + ceiling_area_light() + kSky);
  return scene;
}

/// Triangles against Mitsuba's grid of distances: two balls that run into each other.
SceneText distances() {
  SceneText scene = begin("distances", path(3), {0.5, 1, 5}, 30);
  SdfGrid grid = ball_of_distances(24, 0.25, {0.4, 0.5, 0.5});
  const SdfGrid other = ball_of_distances(24, 0.2, {0.65, 0.6, 0.5});
  for (std::size_t i = 0; i < grid.values.size(); ++i)
    grid.values[i] = std::min(grid.values[i], other.values[i]);
  scene.meshes.push_back({"grid.vol", sdf_file(grid)});
  const std::string shape =
      plugin("shape", "sdfgrid", text("filename", "grid.vol") + text("normals", "smooth") + kWhite);
  scene.both("<shape type=\"shapegroup\" id=\"grid\">" + shape + "</shape>\n" +
             placed("instance", "<translate x=\"-0.5\" y=\"-0.5\" z=\"-0.5\"/><scale value=\"3\"/>\n",
                    "<ref id=\"grid\"/>"));
  scene.both(floor_at(-1.2) + ceiling_area_light() + kSky);
  return scene;
}

SceneText projected_beside_sky() {
  SceneText scene;
  scene.name = "projected-beside-sky";
  scene.each(path(3, text("emitter_sampling", "projected")), path(3));
  scene.both(sensor({0, 1, 5}, {0, 0, 0}, 40) + floor_at(-1) + ceiling_area_light() + kSky);
  return scene;
}

/// A sphere light's inside is dark, and reflects what a point light sends to it. Mitsuba's sphere does not
/// shine at all: where rounding puts a point of its inside to its outside, Mitsuba takes it as lit by the
/// sphere.
SceneText inside_sphere_light() {
  SceneText scene = begin("inside-sphere-light", path(3), {0, 0, 2}, 60);
  scene.each(placed("sphere", "<scale value=\"3\"/>", kWhite + area(2)),
             placed("sphere", "<scale value=\"3\"/>", kWhite));
  scene.both(placed("sphere", "<scale value=\"0.5\"/>", kGrey) +
             "<emitter type=\"point\"><point name=\"position\" value=\"0, 1.5, 0\"/><rgb name=\"intensity\" "
             "value=\"2\"/></emitter>\n");
  return scene;
}

/// And that of one with flipped normals is bright. Mitsuba samples emitters alone: its weights for these and
/// samples of BSDFs together do not add up to 1 inside a sphere.
SceneText inside_flipped_sphere_light() {
  SceneText scene;
  scene.name = "inside-flipped-sphere-light";
  scene.each(plugin("integrator", "direct", ""), plugin("integrator", "direct", integer("bsdf_samples", 0)));
  scene.both(sensor({0, 0, 2}, {0, 0, 0}, 60) +
             placed("sphere", "<scale value=\"3\"/>", boolean("flip_normals", true) + kWhite + area(1)) +
             placed("sphere", "<scale value=\"0.5\"/>", kGrey));
  return scene;
}

SceneText floor_through_centre(bool embree) {
  SceneText scene = begin(embree ? "floor-through-centre-embree" : "floor-through-centre", path(3));
  scene.embree = embree;
  scene.both(floor_at(0) + kSky);
  for (const double y : {1.0, -1.0})
    scene.both(placed("cube", "<scale value=\"0.3\"/>" + translate({0, y, 0}), kGrey));
  return scene;
}

/// Lights that are looked through: to the wall behind, and to a light behind another.
SceneText hidden_area_lights(std::string_view name, const std::string& integrator) {
  SceneText scene = begin(name, integrator);
  scene.both(floor_at(-1) + placed("rectangle", "<scale value=\"3\"/><translate z=\"-2\"/>\n", kWhite));
  scene.both(placed("sphere", "<scale value=\"0.4\"/><translate x=\"-0.8\"/>\n", kGrey + area(2)));
  scene.both(placed("rectangle", "<scale value=\"0.4\"/><translate x=\"0.8\" z=\"1\"/>\n", kWhite + area(2)));
  scene.both(placed(
      "disk", "<scale value=\"0.5\"/><rotate y=\"1\" angle=\"180\"/><translate x=\"0.7\" z=\"-0.5\"/>\n",
      kWhite + area(2)));
  return scene;
}

/// A star in one face, as an object and as a light.
SceneText concave_ply() {
  SceneText scene = begin("concave-ply", path(2), {0, 0, 5}, 30);
  Random random(3);
  scene.meshes.push_back({"star.ply", ply_text(star(5), false, random)});
  scene.meshes.push_back({"star-triangles.ply", ply_text(star(5), true, random)});
  const std::string inside = to_world("<translate x=\"-0.4\"/>") + kWhite;
  const std::string area_light =
      to_world("<scale value=\"0.7\"/><rotate y=\"1\" angle=\"160\"/><translate x=\"0.8\" z=\"1.5\"/>") +
      kWhite + area(5);
  for (const std::string& with : {inside, area_light})
    scene.each(plugin("shape", "ply", text("filename", "star.ply") + with),
               plugin("shape", "ply", text("filename", "star-triangles.ply") + with));
  scene.both(kSky);
  return scene;
}

/// A mirror image of each shape, as light and as one-sided object, whose sides must not change places by
/// mistake.
SceneText mirrored(std::string_view shape, bool flipped) {
  SceneText scene = begin(fmt::format("mirrored-{}{}", shape, flipped ? "-flipped" : ""), path(2));
  std::string type(shape), file;
  if (shape == "obj" || shape == "ply") {
    Random random(4);
    const bool obj = shape == "obj";
    scene.meshes.push_back({"mesh", ""});
    scene.meshes.back().name += obj ? ".obj" : ".ply";
    scene.meshes.back().text = obj ? obj_text(tetrahedron(), true) : ply_text(tetrahedron(), true, random);
    file = text("filename", scene.meshes.back().name) + boolean("face_normals", true);
  }
  if (shape == "smooth") {
    type = "obj";
    scene.meshes.push_back({"mesh.obj", obj_text(ball(6, 9, 1), true)});
    file = text("filename", "mesh.obj");
  }
  const std::string flip = boolean("flip_normals", flipped);
  const auto add = [&](double x, std::string_view mirror, const std::string& light) {
    const std::string place = to_world(fmt::format(
        "<scale {}/><scale value=\"0.5\"/><rotate x=\"1\" angle=\"30\"/><translate x=\"{}\"/>\n", mirror, x));
    const std::string inside = file + place + flip + light;
    scene.each(plugin("shape", type, inside + kGrey),
               plugin("shape", type, inside + (shape == "smooth" ? sides(kGrey) : kGrey)));
  };
  add(-1, "z=\"-1\"", "");
  // Mitsuba's lights take their sides from vertex normals.
  add(1, "x=\"-1\"", shape == "smooth" ? "" : area(3));
  scene.both(floor_at(-1) + kSky);
  return scene;
}

SceneText view_angle(std::string_view axis, bool wide) {
  SceneText scene;
  scene.name = fmt::format("fov-{}-{}", axis, wide ? "wide" : "high");
  const std::string film =
      (wide ? integer("width", 40) + integer("height", 28) : integer("width", 28) + integer("height", 40)) +
      integer("crop_offset_x", 3) + integer("crop_offset_y", 8) + integer("crop_width", 24) +
      integer("crop_height", 18) + plugin("rfilter", "box", "");
  scene.both(path(2) + plugin("sensor", "perspective",
                              real("fov", 45) + text("fov_axis", axis) + look_at({0, 1, 5}, {0, 0, 0}) +
                                  plugin("film", "hdrfilm", film)));
  scene.both(floor_at(-1) + ceiling_area_light() +
             placed("cube", "<scale value=\"0.5\"/><rotate y=\"1\" angle=\"20\"/>", kGrey));
  return scene;
}

/// What is nearer or farther than the clipping planes is not seen, but is there for light.
SceneText clipping_planes() {
  SceneText scene;
  scene.name = "clipping-planes";
  scene.both(path(3) +
             plugin("sensor", "perspective",
                    real("fov", 40) + real("near_clip", 4.6) + real("far_clip", 6) +
                        look_at({0, 1, 5}, {0, 0, 0}) +
                        plugin("film", "hdrfilm",
                               integer("width", 24) + integer("height", 24) + plugin("rfilter", "box", ""))));
  scene.both(floor_at(-1, 4) + ceiling_area_light() + placed("sphere", "", kGrey) + kSky);
  return scene;
}

/// Names in the spelling of versions before 2, which Mitsuba 3 reads too.
SceneText old_spelling() {
  SceneText scene;
  scene.name = "old-spelling";
  scene.version = "0.6.0";
  scene.both(
      "<integrator type=\"path\"><integer name=\"maxDepth\" value=\"3\"/><integer name=\"rrDepth\" "
      "value=\"8\"/></integrator>\n"
      "<sensor type=\"perspective\"><float name=\"fov\" value=\"40\"/><string name=\"fovAxis\" value=\"y\"/>"
      "<transform name=\"toWorld\"><lookat origin=\"0, 1, 5\" target=\"0, 0, 0\" up=\"0, 1, 0\"/></transform>"
      "<film type=\"hdrfilm\"><integer name=\"width\" value=\"24\"/><integer name=\"height\" "
      "value=\"24\"/><rfilter type=\"box\"/></film></sensor>\n"
      "<shape type=\"rectangle\"><transform name=\"toWorld\"><scale value=\"2\"/><rotate x=\"1\" "
      "angle=\"-90\"/></transform>"
      "<bsdf type=\"twosided\"><bsdf type=\"phong\"><spectrum name=\"diffuseReflectance\" "
      "value=\"0.4\"/><rgb name=\"specularReflectance\" value=\"0.3\"/><float name=\"exponent\" "
      "value=\"12\"/></bsdf></bsdf></shape>\n"
      "<shape type=\"sphere\"><float name=\"radius\" value=\"0.5\"/><transform name=\"toWorld\"><translate "
      "y=\"1\"/></transform>"
      "<boolean name=\"flipNormals\" value=\"false\"/><bsdf type=\"diffuse\"/><emitter type=\"area\"><rgb "
      "name=\"radiance\" "
      "value=\"3\"/></emitter></shape>\n");
  return scene;
}

/// Colours in all ways that they are written; Mitsuba 3, which has no sRGB, gets linear ones.
SceneText colours() {
  SceneText scene = begin("colours", path(2));
  scene.colour_error = 4e-4;
  const auto linear = [](double value) { return srgb_to_linear(value); };
  scene.each(placed("rectangle", "<scale value=\"2\"/><rotate x=\"1\" angle=\"-90\"/><translate y=\"-1\"/>",
                    "<bsdf type=\"diffuse\"><srgb name=\"reflectance\" value=\"0.8, 0.5, 0.2\"/></bsdf>"),
             placed("rectangle", "<scale value=\"2\"/><rotate x=\"1\" angle=\"-90\"/><translate y=\"-1\"/>",
                    plugin("bsdf", "diffuse", rgb("reflectance", {linear(0.8), linear(0.5), linear(0.2)}))));
  scene.each(
      placed("sphere", "<scale value=\"0.4\"/><translate x=\"-1\"/>",
             plugin("bsdf", "diffuse", element("rgb", "reflectance", "#80c040"))),
      placed("sphere", "<scale value=\"0.4\"/><translate x=\"-1\"/>",
             plugin("bsdf", "diffuse",
                    rgb("reflectance", {linear(128 / 255.0), linear(192 / 255.0), linear(64 / 255.0)}))));
  scene.both(placed("sphere", "<scale value=\"0.4\"/>",
                    "<bsdf type=\"diffuse\"><spectrum name=\"reflectance\" value=\"400:0.1, 500:0.7, "
                    "600:0.3, 700:0.5\"/></bsdf>"));
  scene.both(placed("sphere", "<scale value=\"0.4\"/><translate x=\"1\"/>",
                    "<bsdf type=\"diffuse\"><spectrum name=\"reflectance\" value=\"0.6\"/></bsdf>"));
  scene.both(placed("rectangle", "<scale value=\"0.6\"/><rotate x=\"1\" angle=\"90\"/><translate y=\"1.4\"/>",
                    kGrey + "<emitter type=\"area\"><spectrum name=\"radiance\" value=\"400:1, 500:4, 600:6, "
                            "700:2\"/></emitter>"));
  scene.both("<emitter type=\"constant\"><spectrum name=\"radiance\" value=\"0.4\"/></emitter>\n");
  return scene;
}

/// The inside of a box light with light that goes to and fro.
SceneText box_light() {
  SceneText scene = begin("box-light", path(5), {0, 0, 0.8}, 60);
  scene.both(placed("cube", "<scale value=\"1.5\"/>", boolean("flip_normals", true) + kGrey + area(1)) +
             placed("sphere", "<scale value=\"0.3\"/>", kGrey));
  return scene;
}

/// Names for objects, defaults and a second name for one of them.
SceneText references() {
  SceneText scene = begin("references",
                          "<default name=\"depth\" value=\"3\"/><integrator type=\"path\"><integer "
                          "name=\"max_depth\" value=\"$depth\"/></integrator>\n");
  scene.both(
      "<bsdf type=\"diffuse\" id=\"red\"><rgb name=\"reflectance\" value=\"0.7, 0.1, 0.1\"/></bsdf>\n<alias "
      "id=\"red\" as=\"rosy\"/>\n"
      "<bsdf type=\"twosided\" id=\"both\"><ref id=\"red\"/></bsdf>\n<emitter type=\"area\" "
      "id=\"area_light\"><rgb "
      "name=\"radiance\" value=\"3\"/></emitter>\n");
  scene.both(placed("sphere", "<scale value=\"0.5\"/>", "<ref id=\"rosy\"/>") +
             placed("disk", "<translate z=\"-1\"/>", "<ref id=\"both\"/>") + floor_at(-1) +
             ceiling_area_light());
  return scene;
}

/// An axis of any length, which Mitsuba wants to be 1.
SceneText long_axis() {
  SceneText scene = begin("long-axis", path(2));
  const double part = 1 / std::sqrt(3.0);
  const std::string cube = "<scale value=\"0.6\"/><rotate value=\"{}\" angle=\"50\"/>\n";
  scene.each(placed("cube", fmt::format(fmt::runtime(cube), "4, 4, 4"), kGrey),
             placed("cube", fmt::format(fmt::runtime(cube), vector_text(glm::dvec3(part))), kGrey));
  scene.both(floor_at(-1.2) + ceiling_area_light());
  return scene;
}

}  // namespace

std::vector<SceneText> named_scenes() {
  const std::string hide = boolean("hide_emitters", true);
  std::vector<SceneText> scenes = {
      area_light_without_bsdf(),
      smooth_rim(),
      distances(),
      curves("spline-curves", "bsplinecurve"),
      curves("linear-curves", "linearcurve"),
      smooth_rim_one_sided(),
      projected_beside_sky(),
      inside_sphere_light(),
      inside_flipped_sphere_light(),
      floor_through_centre(false),
      floor_through_centre(true),
      hidden_area_lights("hidden-area_lights-path", path(3, hide)),
      hidden_area_lights("hidden-area_lights-direct", plugin("integrator", "direct", hide)),
      concave_ply(),
      clipping_planes(),
      old_spelling(),
      colours(),
      box_light(),
      long_axis(),
      references()};
  for (const char* shape : {"rectangle", "cube", "sphere", "disk", "obj", "ply", "smooth"})
    for (const bool flipped : {false, true}) scenes.push_back(mirrored(shape, flipped));
  for (const char* axis : {"x", "y", "diagonal", "smaller", "larger"})
    for (const bool wide : {false, true}) scenes.push_back(view_angle(axis, wide));
  return scenes;
}

}  // namespace penumbra::differential
