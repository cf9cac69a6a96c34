#include "tests/differential/material_scenes.h"

#include <cmath>
#include <functional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "tests/differential/scene_parts.h"
#include "tests/support/measured_writer.h"

namespace penumbra::differential {
namespace {

/// Phong with one lobe in front and another at the back, under each kind of light.
SceneText phong_sides() {
  SceneText scene =
      begin("phong-sides",
            plugin("integrator", "direct", integer("emitter_samples", 2) + integer("bsdf_samples", 2)),
            {0, 0.3, 5}, 30);
  const std::string phong =
      "<bsdf type=\"phong\"><rgb name=\"diffuse_reflectance\" value=\"0.2\"/><rgb "
      "name=\"specular_reflectance\" value=\"0.6\"/><float name=\"exponent\" value=\"40\"/></bsdf>";
  const std::string sides =
      plugin("bsdf", "twosided",
             phong + "<bsdf type=\"diffuse\"><rgb name=\"reflectance\" value=\"0.1, 0.2, 0.6\"/></bsdf>");
  for (const int side : {0, 1})
    scene.both(placed(
        "rectangle",
        fmt::format("<scale value=\"0.6\"/><rotate x=\"1\" angle=\"{}\"/><translate x=\"{}\" y=\"-0.5\"/>\n",
                    side == 0 ? -70 : 110, side == 0 ? -0.7 : 0.7),
        sides));
  scene.both(placed("disk",
                    "<scale value=\"0.6\"/><rotate x=\"1\" angle=\"45\"/><translate y=\"1.6\" z=\"-1.5\"/>\n",
                    kGrey + area(4)) +
             kSky);
  return scene;
}

/// What is of polarised light in Mitsuba, without polarisation.
SceneText polarizers() {
  // Passing costs depth in Mitsuba alone.
  SceneText scene = begin("polarizers", path(24));
  double x = -1.2;
  for (const char* type : {"polarizer", "retarder", "circular"}) {
    scene.both(placed("rectangle", "<scale value=\"0.5\"/>" + translate({x, 0, 0.6}),
                      plugin("bsdf", type, rgb("transmittance", glm::dvec3(0.8)))));
    x += 1.2;
  }
  const auto plastic = [](std::string_view distribution, double alpha, const glm::dvec3& colour) {
    return plugin(
        "bsdf", "pplastic",
        rgb("diffuse_reflectance", colour) + text("distribution", distribution) + real("alpha", alpha));
  };
  scene.both(placed("sphere", "<scale value=\"0.5\"/>" + translate({-0.8, -0.3, -0.5}),
                    plastic("ggx", 0.3, {0.8, 0.3, 0.1})));
  scene.both(placed("sphere", "<scale value=\"0.5\"/>" + translate({0.8, -0.3, -0.5}),
                    plastic("beckmann", 0.12, {0.1, 0.5, 0.9})));
  scene.both(floor_at(-0.8) + ceiling_area_light() + kSky);
  return scene;
}

/// Plastics, smooth and rough, one- and two-sided.
SceneText plastics(std::string_view name, const std::string& integrator, bool nonlinear) {
  SceneText scene = begin(name, integrator);
  const auto plastic = [&](std::string_view type, const glm::dvec3& colour, const std::string& more) {
    return plugin("bsdf", type, rgb("diffuse_reflectance", colour) + boolean("nonlinear", nonlinear) + more);
  };
  const std::string smooth = plastic("plastic", {0.8, 0.3, 0.1}, real("int_ior", 1.9));
  const std::string ggx = plastic("roughplastic", {0.1, 0.5, 0.9},
                                  text("distribution", "ggx") + real("alpha", 0.3) + text("int_ior", "bk7"));
  const std::string beckmann = plastic("roughplastic", {0.7, 0.7, 0.2},
                                       real("alpha", 0.15) + rgb("specular_reflectance", {0.9, 0.6, 0.3}));
  double x = -1.2;
  for (const std::string& bsdf : {smooth, ggx, beckmann}) {
    scene.both(placed("sphere", "<scale value=\"0.5\"/>" + translate({x, -0.3, 0}), bsdf));
    x += 1.2;
  }
  scene.both(placed("rectangle",
                    "<scale value=\"2\"/><rotate x=\"1\" angle=\"-90\"/><translate y=\"-0.8\"/>\n",
                    plugin("bsdf", "twosided", plastic("roughplastic", {0.4, 0.4, 0.4}, ""))));
  scene.both(ceiling_area_light() + kSky);
  return scene;
}

/// A ball of a principled BSDF of these numbers.
SceneText principled(std::string_view name, std::string_view type,
                     const std::vector<std::pair<std::string_view, double>>& numbers) {
  SceneText scene = begin(name, path(6));
  std::string bsdf = rgb("base_color", {0.8, 0.35, 0.1});
  for (const auto& [parameter, value] : numbers) bsdf += real(parameter, value);
  scene.both(placed("sphere", "<scale value=\"0.8\"/>", plugin("bsdf", type, bsdf)) + floor_at(-1) + kSky +
             ceiling_area_light());
  return scene;
}

/// A ball of a measured material, whose tangents are the sphere's.
SceneText measured(std::string_view name, const MeasuredFormula& formula) {
  SceneText scene = begin(name, path(6));
  scene.meshes.push_back({"metal.bsdf", measured_fields(formula).file()});
  scene.both(placed("sphere", "<scale value=\"0.8\"/><rotate x=\"1\" angle=\"70\"/>",
                    plugin("bsdf", "measured", text("filename", "metal.bsdf"))) +
             floor_at(-1) + kSky + ceiling_area_light());
  return scene;
}

const std::string kBoard =
    "<texture type=\"checkerboard\" name=\"NAME\"><rgb name=\"color0\" value=\"0.1\"/><rgb name=\"color1\" "
    "value=\"0.8\"/><transform name=\"to_uv\"><scale x=\"3\" y=\"2\"/></transform></texture>\n";

std::string board(std::string_view name) {
  std::string text = kBoard;
  return text.replace(text.find("NAME"), 4, name);
}

std::string diffuse(glm::dvec3 colour) { return plugin("bsdf", "diffuse", rgb("reflectance", colour)); }
std::string two_sided(const std::string& bsdf) { return plugin("bsdf", "twosided", bsdf); }

/// Masks in a row, one of squares and one in a blend, before a light and the sky. Passed surfaces are bounces
/// to Mitsuba, so depth has no limit; its shadow rays do not pass, which is only noise.
SceneText masks() {
  SceneText scene = begin("masks", path(-1));
  scene.samples = 4;
  const std::string orange = two_sided(diffuse({0.8, 0.5, 0.2}));
  const std::string holes = plugin("bsdf", "mask", board("opacity") + orange);
  const std::string one_sided = plugin("bsdf", "mask", real("opacity", 0.6) + diffuse({0.2, 0.5, 0.7}));
  const std::string blend =
      plugin("bsdf", "blendbsdf", real("weight", 0.3) + holes + plugin("bsdf", "null", ""));
  scene.both(floor_at(-1) + ceiling_area_light() + kSky);
  scene.both(placed("rectangle", "<scale value=\"0.8\"/><translate x=\"-0.6\" z=\"1\"/>\n", holes));
  scene.both(placed("sphere", "<scale value=\"0.5\"/><translate x=\"0.9\"/>\n", one_sided));
  scene.both(placed("sphere", "<scale value=\"0.4\"/>\n", holes));
  scene.both(placed("rectangle",
                    "<scale value=\"1.5\"/><rotate x=\"1\" angle=\"-90\"/><translate y=\"0.8\"/>\n", blend));
  return scene;
}

/// A light of nothing, through which another is seen.
SceneText null_area_lights() {
  SceneText scene = begin("null-area_lights", path(-1));
  const std::string nothing = plugin("bsdf", "null", "");
  // With a sky: rays that end on nothing are black in Mitsuba, whatever they passed.
  scene.both(floor_at(-1) + ceiling_area_light() + kSky);
  scene.both(placed("sphere", "<scale value=\"0.5\"/><translate y=\"-0.2\"/>\n", nothing + area(0.7)));
  scene.both(
      placed("rectangle", "<scale value=\"0.5\"/><translate x=\"0.6\" z=\"0.8\"/>\n", nothing + area(0.4)));
  scene.both(placed("cube", "<scale value=\"0.3\"/><translate x=\"-0.8\" z=\"-0.5\"/>\n", kGrey));
  return scene;
}

SceneText blends() {
  SceneText scene = begin("blends", path(4));
  const std::string pair = diffuse({0.9, 0.2, 0.1}) + diffuse({0.1, 0.3, 0.9});
  scene.both(floor_at(-1) + ceiling_area_light() + kSky);
  const std::string ball = placed("sphere", "<scale value=\"0.5\"/><translate x=\"-0.7\"/>\n",
                                  plugin("bsdf", "blendbsdf", board("weight") + pair));
  scene.both(ball);
  scene.both(placed("cube", "<scale value=\"0.4\"/><rotate y=\"1\" angle=\"30\"/><translate x=\"0.7\"/>\n",
                    two_sided(plugin("bsdf", "blendbsdf", real("weight", 0.25) + pair))));
  return scene;
}

/// An image of 24-bit texels, rows from the top, as a PPM file.
std::string ppm_text(int size, const std::function<glm::dvec3(double, double)>& value) {
  std::string text = fmt::format("P6\n{} {}\n255\n", size, size);
  for (int y = 0; y < size; ++y)
    for (int x = 0; x < size; ++x) {
      const glm::dvec3 colour = value((x + 0.5) / size, (y + 0.5) / size);
      for (int k = 0; k < 3; ++k) text += char(int(std::lround(255 * colour[k])));
    }
  return text;
}

/// Maps that bend the normals of a wall, of a ball and of a sheet seen from behind, two-sided in two ways.
/// Mitsuba darkens bumps by a term of its own, unless told not to.
SceneText bent(std::string_view type) {
  SceneText scene = begin(type, path(3), {0, 0.6, 5}, 36);
  scene.samples = 2;
  const double turn = 2 * 3.14159265358979;
  const bool normals = type == "normalmap";
  scene.meshes.push_back({"map.ppm", ppm_text(16, [&](double u, double v) {
                            const double h_u = std::cos(turn * u), h_v = -0.7 * std::sin(turn * v);
                            if (!normals)
                              return glm::dvec3(0.5 + 0.2 * std::sin(turn * u) + 0.15 * std::cos(turn * v));
                            return 0.5 + 0.5 * glm::normalize(glm::dvec3(-0.6 * h_u, -0.6 * h_v, 1));
                          })});
  const std::string texture = plugin(
      "texture", "bitmap", text("filename", "map.ppm") + boolean("raw", true) + text("wrap_mode", "clamp"));
  const std::string name = "<texture type=\"bitmap\" name=\"normalmap\">";
  const std::string named = name + texture.substr(texture.find('>') + 1);
  const auto add = [&](const std::string& place, const std::string& shape, bool outside, double bump,
                       const std::string& file = "") {
    const std::string white = diffuse(glm::dvec3(0.7));
    const std::string map =
        (normals ? named : texture + real("scale", bump)) + (outside ? two_sided(white) : white);
    const std::string bsdf = plugin("bsdf", type, map);
    scene.both(placed(shape, place, file + (outside ? bsdf : two_sided(bsdf))));
  };
  add("<scale value=\"0.7\"/><translate x=\"-0.8\"/>\n", "rectangle", false, 0.4);
  add("<scale value=\"0.6\"/><rotate y=\"1\" angle=\"200\"/><translate x=\"0.8\" y=\"0.6\"/>\n", "rectangle",
      true, 0.4);
  add("<scale value=\"0.6\"/><rotate y=\"1\" angle=\"160\"/><translate x=\"0.8\" y=\"-0.7\"/>\n", "rectangle",
      false, 0.4);
  add("<scale value=\"0.5\"/><translate y=\"0.9\" z=\"-1\"/>\n", "sphere", false, 0.3);
  // Without texture coordinates.
  scene.meshes.push_back({"fold.obj", "v -1 -1 0\nv 1 -1 0.5\nv 1 1 0\nv -1 1 0.3\nf 1 2 3\nf 1 3 4\n"});
  add("<scale value=\"0.35\"/><translate x=\"0.1\" y=\"-0.5\" z=\"0.6\"/>\n", "obj", true, 0.2,
      text("filename", "fold.obj") + boolean("face_normals", true));
  scene.both(floor_at(-1.4));
  scene.both(
      placed("rectangle",
             "<scale value=\"0.6\"/><rotate y=\"1\" angle=\"110\"/><translate x=\"-3\" z=\"2\" y=\"1\"/>\n",
             kGrey + area(12)));
  return scene;
}

}  // namespace

std::vector<SceneText> material_scenes() {
  const std::string direct =
      plugin("integrator", "direct", integer("emitter_samples", 2) + integer("bsdf_samples", 2));
  std::vector<SceneText> scenes = {phong_sides(),
                                   plastics("plastics", path(4), false),
                                   plastics("plastics-nonlinear", path(4), true),
                                   plastics("plastics-direct", direct, false),
                                   polarizers(),
                                   masks(),
                                   null_area_lights(),
                                   blends(),
                                   bent("normalmap"),
                                   bent("bumpmap")};
  scenes.push_back(principled("principled-metal", "principled",
                              {{"metallic", 1}, {"roughness", 0.5}, {"anisotropic", 0.9}, {"clearcoat", 1}}));
  scenes.push_back(principled("principled-cloth", "principled",
                              {{"sheen", 1}, {"sheen_tint", 0.5}, {"flatness", 0.7}, {"spec_tint", 1}}));
  scenes.push_back(principled(
      "principled-glass", "principled",
      {{"spec_trans", 0.8}, {"metallic", 0.1}, {"roughness", 0.6}, {"eta", 1.4}, {"anisotropic", 0.5}}));
  scenes.push_back(measured("measured", isotropic_formula()));
  scenes.push_back(measured("measured-anisotropic", anisotropic_formula()));
  scenes.push_back(measured("measured-strange", strange_formula()));
  scenes.push_back(principled(
      "principledthin", "principledthin",
      {{"spec_trans", 0.5}, {"diff_trans", 0.8}, {"roughness", 0.6}, {"sheen", 0.5}, {"spec_tint", 0.5}}));
  return scenes;
}

}  // namespace penumbra::differential
