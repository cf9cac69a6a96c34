#include "gl/camera_text.h"

#include <fmt/format.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

namespace penumbra {
namespace {

glm::dvec3 vector(vec3 v) { return {v.x, v.y, v.z}; }

/// The shortest text that gives the same float; more digits for what a float does not represent, as for
/// scenes far from the origin.
std::string number(double x) {
  const auto nearest = float(x);
  constexpr double kFloatRounding = 6e-8;
  if (std::abs(double(nearest) - x) <= 1e-3 * kFloatRounding * std::abs(x) || std::abs(x) < 1e-6)
    return fmt::format("{}", nearest == 0 ? 0.0f : nearest);  // no "-0"
  return fmt::format("{:.9g}", x);
}

std::string numbers(const glm::dvec3& v, const char* between) {
  return number(v.x) + between + number(v.y) + between + number(v.z);
}

/// The vertical angle of view in degrees.
double vertical_fov(const Camera& camera) {
  return 2 * std::atan(glm::length(vector(camera.y))) * 180 / std::numbers::pi;
}

/// By rows; camera space is x to the left, y upwards, z along the view.
std::string to_world_text(const Camera& camera, const CameraPlace& place) {
  const glm::dvec3 x = glm::normalize(vector(camera.x)), z = glm::normalize(place.at - place.eye);
  std::string text;
  for (int row = 0; row < 3; ++row)
    text += numbers({x[row], place.up[row], z[row]}, " ") + " " + number(place.eye[row]) + " ";
  return text + "0 0 0 1";
}

}  // namespace

CameraPlace camera_place(const Camera& camera, const glm::dvec3& center, double distance) {
  const glm::dvec3 x = vector(camera.x), y = vector(camera.y), z = glm::normalize(vector(camera.z));
  const glm::dvec3 eye = vector(camera.origin) + center;
  return {eye, eye + distance * z, glm::normalize(y), glm::dot(glm::cross(x, y), z) < 0};
}

std::string camera_text(const Camera& camera, const glm::dvec3& center, double distance,
                        CameraFormat format) {
  const CameraPlace place = camera_place(camera, center, distance);
  const bool has_fov = camera.parallel == 0 && camera.panorama == 0;
  switch (format) {
    case CameraFormat::kSettings:
      if (place.is_mirrored) return "camera.to_world=" + to_world_text(camera, place);
      return fmt::format("camera.lookat={} {} {}", numbers(place.eye, " "), numbers(place.at, " "),
                         numbers(place.up, " "));
    case CameraFormat::kMitsuba: {
      std::string text = "<transform name=\"to_world\">\n";
      text += place.is_mirrored
                  ? fmt::format("  <matrix value=\"{}\"/>\n", to_world_text(camera, place))
                  : fmt::format("  <lookat origin=\"{}\" target=\"{}\" up=\"{}\"/>\n",
                                numbers(place.eye, ", "), numbers(place.at, ", "), numbers(place.up, ", "));
      text += "</transform>\n";
      if (has_fov)
        text +=
            fmt::format("<string name=\"fov_axis\" value=\"y\"/>\n<float name=\"fov\" value=\"{:.9g}\"/>\n",
                        vertical_fov(camera));
      return text;
    }
    case CameraFormat::kTinyRender:
      return fmt::format("[camera]\neye = [{}]\nat = [{}]\nup = [{}]\n{}", numbers(place.eye, ", "),
                         numbers(place.at, ", "), numbers(place.up, ", "),
                         has_fov ? fmt::format("fov = {:.9g}\n", vertical_fov(camera)) : "");
  }
  return {};
}

}  // namespace penumbra
