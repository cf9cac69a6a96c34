#include "tests/differential/media_scenes.h"

#include <cmath>

#include "scenes/volume_file.h"
#include "tests/differential/scene_parts.h"

namespace penumbra::differential {
namespace {

const std::string kNull = plugin("bsdf", "null", "");

std::string hg(double g) { return plugin("phase", "hg", real("g", g)); }

std::string medium(std::string_view id, glm::dvec3 extinction, double scale, glm::dvec3 albedo,
                   const std::string& phase) {
  return fmt::format("<medium type=\"homogeneous\" id=\"{}\">\n{}{}{}{}</medium>\n", id,
                     rgb("sigma_t", extinction), real("scale", scale), rgb("albedo", albedo), phase);
}

std::string reference(std::string_view id, std::string_view name) {
  return fmt::format("<ref id=\"{}\" name=\"{}\"/>\n", id, name);
}

std::string volpath(std::string_view type, int depth) {
  return plugin("integrator", type, integer("max_depth", depth));
}

std::string ball(glm::dvec3 center, double radius, const std::string& inside) {
  return placed("sphere", fmt::format("<scale value=\"{}\"/>", radius) + translate(center), inside);
}

/// A floor under a light, and media before all else.
SceneText room(std::string_view name, const std::string& integrator, const std::string& media,
               const std::string& camera_medium = "") {
  SceneText scene;
  scene.name = name;
  scene.both(media + integrator +
             plugin("sensor", "perspective",
                    real("fov", 40) + look_at({0, 1, 5}, {0, 0, 0}) + camera_medium +
                        plugin("film", "hdrfilm",
                               integer("width", 24) + integer("height", 24) + plugin("rfilter", "box", ""))));
  scene.both(floor_at(-1) + ceiling_area_light());
  return scene;
}

/// Extinction .255 around everything, of which .005 absorbs: no boundary at all.
SceneText everywhere(double g) {
  return room(fmt::format("medium-everywhere-{}", g), volpath("volpath", 8),
              medium("m", glm::dvec3(0.255), 1, glm::dvec3(0.25 / 0.255), hg(g)), reference("m", "medium"));
}

/// A ball that absorbs or scatters alone.
SceneText one_ball(std::string_view name, std::string_view integrator, glm::dvec3 extinction, double scale,
                   glm::dvec3 albedo, const std::string& phase, const std::string& bsdf = kNull) {
  SceneText scene = room(name, volpath(integrator, 12), medium("m", extinction, scale, albedo, phase));
  scene.both(ball({0, 0, 0}, 0.9, bsdf + reference("m", "interior")) + kSky);
  return scene;
}

SceneText nested() {
  SceneText scene = room("media-nested", volpath("volpath", 12),
                         medium("outer", {0.4, 0.6, 0.8}, 1, {0.9, 0.8, 0.7}, hg(0.3)) +
                             medium("inner", {0.9, 0.5, 0.3}, 4, {0.5, 0.8, 0.9}, hg(-0.5)));
  scene.both(ball({0, 0, 0}, 0.95, kNull + reference("outer", "interior")));
  scene.both(
      ball({0.2, 0.1, 0}, 0.5, kNull + reference("inner", "interior") + reference("outer", "exterior")));
  scene.both(kSky);
  return scene;
}

SceneText area_light_within() {
  SceneText scene = room("medium-area-light-within", volpath("volpath", 12),
                         medium("m", {0.5, 0.7, 1}, 2, {0.9, 0.9, 0.6}, hg(0.5)));
  scene.both(ball({0, 0, 0}, 0.9, kNull + reference("m", "interior")));
  scene.both(ball({0.1, 0.1, 0}, 0.2, kGrey + reference("m", "exterior") + area(6)));
  return scene;
}

SceneText from_within() {
  SceneText scene =
      room("medium-camera-within", volpath("volpath", 12),
           medium("m", {0.1, 0.15, 0.2}, 1, {0.9, 0.8, 0.7}, hg(0.7)), reference("m", "medium"));
  scene.both(ball({0, 0, 5}, 4, kNull + reference("m", "interior")) + kSky);
  return scene;
}

/// Thin panes, which volpath's rays pass, and which balls have on both sides; without a medium, or with one.
SceneText panes(bool medium_too) {
  SceneText scene = room(medium_too ? "panes-and-medium" : "panes", volpath("volpath", 3),
                         medium_too ? medium("m", {0.9, 0.5, 0.3}, 1, {0.5, 0.8, 0.9}, hg(0)) : "");
  const std::string pane =
      plugin("bsdf", "thindielectric", real("int_ior", 2.1) + rgb("specular_reflectance", {0.9, 0.7, 0.8}));
  scene.both(ball({-0.6, 0, 0}, 0.7, pane) +
             placed("cube", "<scale value=\"0.4\"/><translate x=\"0.9\"/>\n", pane));
  if (medium_too) scene.both(ball({0.9, -0.7, 1}, 0.3, kNull + reference("m", "interior")));
  scene.both(kSky);
  return scene;
}

/// Fog that ends nowhere, in a scene without triangles.
SceneText fog() {
  SceneText scene;
  scene.name = "fog";
  scene.both(medium("m", {0.1, 0.2, 0.3}, 1, glm::dvec3(0.5), hg(0)) + volpath("volpath", 16) +
             plugin("sensor", "perspective",
                    real("fov", 40) + look_at({0, 1, 4}, {0, 0, 0}) + reference("m", "medium") +
                        plugin("film", "hdrfilm",
                               integer("width", 24) + integer("height", 24) + plugin("rfilter", "box", ""))));
  scene.both(ball({0, 0, 0}, 0.5, kGrey));
  scene.both("<emitter type=\"point\">\n<point name=\"position\" x=\"0\" y=\"2\" z=\"1\"/>\n" +
             rgb("intensity", glm::dvec3(5)) + "</emitter>\n");
  return scene;
}

/// A cloud of which extinction, and albedo if it is `coloured`, are grids.
SceneText cloud(bool coloured, bool nearest) {
  SceneText scene;
  VolumeGrid density, albedo;
  density.nx = 12, density.ny = 9, density.nz = 10;
  for (int z = 0; z < density.nz; ++z)
    for (int y = 0; y < density.ny; ++y)
      for (int x = 0; x < density.nx; ++x)
        density.values.push_back(
            float(std::max(0.0, std::sin(0.7 * x) * std::cos(0.5 * y) + std::sin(0.9 * z))));
  albedo.nx = 2, albedo.ny = 3, albedo.nz = 2, albedo.channels = 3;
  for (int k = 0; k < 36; ++k) albedo.values.push_back(0.3f + 0.018f * float(k * 7 % 36));
  const std::string place =
      to_world("<translate x=\"-0.5\" y=\"-0.5\" z=\"-0.5\"/><scale value=\"1.6\"/>\n") +
      text("filter_type", nearest ? "nearest" : "trilinear");
  const auto grid = [&](std::string_view name, std::string_view file) {
    return fmt::format("<volume type=\"gridvolume\" name=\"{}\">\n{}{}{}</volume>\n", name,
                       text("filename", file), boolean("raw", true), place);
  };
  const std::string inside = grid("sigma_t", "density.vol") +
                             (coloured ? grid("albedo", "albedo.vol") : rgb("albedo", {0.9, 0.8, 0.6})) +
                             real("scale", 3) + hg(0.3);
  scene = room(fmt::format("medium-grid{}{}", coloured ? "-coloured" : "", nearest ? "-nearest" : ""),
               volpath("volpath", 12), "<medium type=\"heterogeneous\" id=\"m\">\n" + inside + "</medium>\n");
  scene.meshes = {{"density.vol", vol_of(density, glm::dvec3(0), glm::dvec3(1))},
                  {"albedo.vol", vol_of(albedo, glm::dvec3(0), glm::dvec3(1))}};
  scene.both(placed("cube", "<scale value=\"0.8\"/>\n", kNull + reference("m", "interior")) + kSky);
  return scene;
}

}  // namespace

std::vector<SceneText> media_scenes() {
  const std::string blend =
      plugin("phase", "blendphase", real("weight", 0.4) + hg(0.6) + plugin("phase", "rayleigh", ""));
  const glm::dvec3 grey(0.5), colours(0.2, 0.5, 1);
  return {everywhere(0),
          everywhere(0.7),
          everywhere(-0.7),
          one_ball("medium-absorbs", "volpath", grey, 2, glm::dvec3(0), hg(0)),
          one_ball("medium-scatters", "volpath", grey, 2, glm::dvec3(1), hg(0)),
          one_ball("medium-forward", "volpath", grey, 2, glm::dvec3(1), hg(0.7)),
          one_ball("medium-backward", "volpath", grey, 2, glm::dvec3(1), hg(-0.7)),
          one_ball("medium-coloured", "volpath", colours, 4, {0.9, 0.7, 0.95}, hg(0.4)),
          one_ball("medium-coloured-mis", "volpathmis", colours, 4, {0.9, 0.7, 0.95}, hg(0.4)),
          one_ball("medium-blend", "volpath", grey, 3, {0.8, 0.9, 0.99}, blend),
          one_ball("medium-rayleigh", "volpath", grey, 3, {0.8, 0.9, 0.99}, plugin("phase", "rayleigh", "")),
          one_ball("medium-in-glass", "volpath", grey, 2, {0.8, 0.9, 0.99}, hg(0.3),
                   plugin("bsdf", "dielectric", real("int_ior", 1.3))),
          one_ball("medium-in-rough-glass", "volpath", grey, 2, {0.8, 0.9, 0.99}, hg(0.3),
                   plugin("bsdf", "roughdielectric", real("int_ior", 1.3) + real("alpha", 0.3))),
          nested(),
          area_light_within(),
          from_within(),
          cloud(false, false),
          panes(false),
          panes(true),
          fog(),
          cloud(true, false),
          cloud(false, true)};
}

}  // namespace penumbra::differential
