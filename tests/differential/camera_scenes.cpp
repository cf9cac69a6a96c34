#include "tests/differential/camera_scenes.h"

#include <string>
#include <string_view>

namespace penumbra::differential {
namespace {

constexpr std::string_view kFrom = "<lookat origin=\"0.3, 0.8, 5\" target=\"0, 0, 0\" up=\"0.1, 1, 0\"/>\n";

/// `steps`: of the camera's transform before it is put in its place.
SceneText through(std::string_view name, std::string_view camera, std::string_view steps,
                  const std::string& settings) {
  SceneText scene;
  scene.name = name;
  const std::string film =
      plugin("film", "hdrfilm", integer("width", 30) + integer("height", 24) + plugin("rfilter", "box", ""));
  scene.both(plugin("integrator", "path", integer("max_depth", 3)) +
             plugin("sensor", camera, to_world(std::string(steps) + std::string(kFrom)) + settings + film));
  const auto diffuse = [](glm::dvec3 colour) {
    return plugin("bsdf", "twosided", plugin("bsdf", "diffuse", rgb("reflectance", colour)));
  };
  const glm::dvec3 colours[] = {{0.8, 0.2, 0.1}, {0.2, 0.7, 0.3}, {0.2, 0.3, 0.9}, {0.8, 0.8, 0.2}};
  double z = 2.5;
  for (const glm::dvec3& colour : colours) {
    scene.both(
        plugin("shape", "sphere",
               to_world("<scale value=\"0.4\"/>" + translate({0.5 * z - 0.4, -0.3, z})) + diffuse(colour)));
    z -= 1.7;
  }
  scene.both(
      plugin("shape", "rectangle",
             to_world("<scale value=\"6\"/><rotate x=\"1\" angle=\"-90\"/>" + translate({0, -0.8, 0})) +
                 diffuse({0.6, 0.6, 0.6})));
  scene.both(plugin("shape", "sphere",
                    to_world("<scale value=\"0.3\"/>" + translate({-1, 1, -1})) +
                        plugin("emitter", "area", rgb("radiance", {6, 5, 4}))));
  scene.both(plugin("emitter", "constant", rgb("radiance", {0.4, 0.5, 0.6})));
  return scene;
}

}  // namespace

std::vector<SceneText> camera_scenes() {
  const std::string fov = real("fov", 42), mirror = "<scale x=\"-1\"/>";
  const std::string lens = fov + real("aperture_radius", 0.25);
  return {
      through("thin-lens", "thinlens", "", lens + real("focus_distance", 4.2)),
      through("thin-lens-near", "thinlens", "", lens + real("focus_distance", 2)),
      through("thin-lens-without-focus", "thinlens", "", lens + real("far_clip", 30)),
      through("thin-lens-mirrored", "thinlens", mirror,
              lens + real("focus_distance", 5) + text("fov_axis", "y")),
      through("orthographic", "orthographic", "<scale value=\"1.7\"/>", ""),
      through("orthographic-stretched", "orthographic", "<scale x=\"-1.2\" y=\"2.1\" z=\"4\"/>",
              real("near_clip", 0.5) + real("far_clip", 6)),
      through("principal-point", "perspective", "",
              fov + real("principal_point_offset_x", 0.15) + real("principal_point_offset_y", -0.22)),
      through("principal-point-mirrored", "perspective", mirror,
              fov + real("principal_point_offset_x", 0.15)),
      through("perspective-mirrored", "perspective", "<scale y=\"-1\"/>", fov),
  };
}

}  // namespace penumbra::differential
