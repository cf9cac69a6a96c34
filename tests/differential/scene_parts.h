// Parts of differential scenes.
#pragma once

#include <string>
#include <string_view>

#include "tests/differential/scene_text.h"

namespace penumbra::differential {

inline const std::string kWhite =
    "<bsdf type=\"twosided\"><bsdf type=\"diffuse\"><rgb name=\"reflectance\" "
    "value=\"0.7\"/></bsdf></bsdf>\n";
inline const std::string kGrey = "<bsdf type=\"diffuse\"><rgb name=\"reflectance\" value=\"0.5\"/></bsdf>\n";
inline const std::string kSky =
    "<emitter type=\"constant\"><rgb name=\"radiance\" value=\"0.5, 0.6, 0.7\"/></emitter>\n";

inline std::string sensor(glm::dvec3 eye, glm::dvec3 target, double fov,
                          const std::string& film_settings = "") {
  const std::string size =
      film_settings.empty() ? integer("width", 24) + integer("height", 24) : film_settings;
  return plugin("sensor", "perspective",
                real("fov", fov) + look_at(eye, target) +
                    plugin("film", "hdrfilm", size + plugin("rfilter", "box", "")));
}

inline std::string area(double radiance, const std::string& settings = "") {
  return plugin("emitter", "area", rgb("radiance", glm::dvec3(radiance)) + settings);
}

inline std::string placed(std::string_view type, std::string_view steps, const std::string& inside) {
  return plugin("shape", type, to_world(steps) + inside);
}

inline std::string path(int depth, const std::string& settings = "") {
  return plugin("integrator", "path", integer("max_depth", depth) + settings);
}

inline std::string floor_at(double y, double size = 2) {
  return placed(
      "rectangle",
      fmt::format("<scale value=\"{}\"/><rotate x=\"1\" angle=\"-90\"/><translate y=\"{}\"/>\n", size, y),
      kWhite);
}

/// A light under the ceiling that looks down.
inline std::string ceiling_area_light(const std::string& settings = "") {
  return placed("rectangle", "<scale value=\"0.6\"/><rotate x=\"1\" angle=\"90\"/><translate y=\"1.2\"/>\n",
                kGrey + area(4, settings));
}

/// For vertex normals: see Sides in render_with_mitsuba.py.
inline std::string sides(const std::string& bsdf) { return plugin("bsdf", "sides", bsdf); }

inline SceneText begin(std::string_view name, const std::string& integrator, glm::dvec3 eye = {0, 1, 5},
                       double fov = 40) {
  SceneText scene;
  scene.name = name;
  scene.both(integrator + sensor(eye, {0, 0, 0}, fov));
  return scene;
}

}  // namespace penumbra::differential
