#include "scenes/gltf/view_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "scenes/motion/scene_motion.h"
#include "scenes/punctual_lights.h"
#include "scenes/transform.h"

namespace penumbra::gltf {
namespace {

constexpr int kLooks = 9;         ///< the times at which a moving scene is looked at
constexpr int kMostSide = 16384;  ///< largest film size that follows from an aspect ratio

/// glTF has no resolution, so the film's height is kept. False if the width would be 0 or too large.
bool set_width(double aspect, SceneDescription& scene) {
  const double width = std::round(scene.film.height * aspect);
  if (!(width >= 1 && width <= kMostSide)) return false;
  scene.film.width = scene.film.crop_width = int(width);
  return true;
}

}  // namespace

glm::dmat4 camera_space() { return scaling(glm::dvec3(-1.0, 1.0, -1.0)); }

void read_camera(const Asset& asset, int camera, const glm::dmat4& to_world, ReaderReport& report,
                 SceneDescription& scene) {
  const SourceLocation location = asset.place({"cameras", std::size_t(camera)});
  const tinygltf::Camera& gltf = asset.model.cameras[std::size_t(camera)];
  const glm::dmat4 facing = to_world * camera_space();
  if (!without_scale(facing))
    report.warn(location,
                fmt::format("camera {}: nodes above it shear it; its view and its upper half plane are kept",
                            camera));
  const auto frame = camera_frame(facing);
  if (!frame) return report.error(location, fmt::format("camera {}: {}", camera, frame.error().message));
  scene.camera.to_world = *frame;
  if (gltf.type == "orthographic") {
    const tinygltf::OrthographicCamera& view = gltf.orthographic;
    // Negative values are discouraged and mean the same view.
    const double xmag = std::abs(view.xmag), ymag = std::abs(view.ymag);
    if (!(xmag > 0.0 && ymag > 0.0 && xmag < 1e30 && ymag < 1e30))
      return report.error(location,
                          fmt::format("xmag and ymag must not be 0: {} and {}", view.xmag, view.ymag));
    if (!(view.znear >= 0.0 && view.zfar > view.znear && view.zfar < 1e37))
      return report.error(location,
                          fmt::format("zfar must be beyond znear, {}, not {}", view.znear, view.zfar));
    scene.camera.projection = Projection::kOrthographic;
    if (!set_width(xmag / ymag, scene))
      return report.error(location, fmt::format("an image {} times as wide as high", xmag / ymag));
    scene.camera.scale_x = xmag;
    scene.camera.scale_y = ymag * scene.film.width / scene.film.height;
    scene.camera.near_clip = std::max(view.znear, 1e-6 * view.zfar);
    scene.camera.far_clip = view.zfar;
    return;
  }
  if (gltf.type != "perspective")
    return report.unsupported(location, fmt::format("{} cameras are not read", gltf.type),
                              "a perspective one stands in for it");
  const tinygltf::PerspectiveCamera& view = gltf.perspective;
  if (!(view.yfov > 0.0 && view.yfov < std::numbers::pi))
    return report.error(location, fmt::format("yfov must be between 0 and pi, not {}", view.yfov));
  scene.camera.fov = view.yfov * kDegrees;
  scene.camera.fov_axis = FovAxis::kY;
  if (!(view.znear > 0.0) || !std::isfinite(view.znear))
    return report.error(location, fmt::format("znear must be above 0, not {}", view.znear));
  scene.camera.near_clip = view.znear;
  // Without zfar the view is infinite.
  scene.camera.far_clip = view.zfar > 0.0 && std::isfinite(view.zfar) ? view.zfar : 1e30;
  if (!(scene.camera.far_clip > scene.camera.near_clip) || scene.camera.far_clip > 1e37)
    return report.error(location,
                        fmt::format("zfar must be beyond znear, {}, not {}", view.znear, view.zfar));
  if (view.aspectRatio > 0.0 && !set_width(view.aspectRatio, scene))
    report.error(location, fmt::format("an image {} times as wide as high", view.aspectRatio));
}

void look_at_everything(SceneDescription& scene) {
  glm::dvec3 low(std::numeric_limits<double>::max()), high(-std::numeric_limits<double>::max());
  const auto enclose = [&](const std::vector<Shape>& shapes, const glm::dmat4& to_world) {
    for (const Shape& shape : shapes)
      if (const auto* mesh = std::get_if<Mesh>(&shape.geometry))
        for (const glm::dvec3& p : mesh->positions) {
          const glm::dvec3 placed = transform_point(to_world, p);
          low = glm::min(low, placed);
          high = glm::max(high, placed);
        }
  };
  const auto moving = scene.motion != nullptr ? time_range(*scene.motion) : std::nullopt;
  for (int look = 0; look < (moving ? kLooks : 1); ++look) {
    if (moving) {
      const double t = double(look) / (kLooks - 1);
      // A time that cannot be shown is an error once it is asked for.
      if (!set_time(scene, (1.0 - t) * moving->first + t * moving->second)) continue;
    }
    enclose(scene.shapes, glm::dmat4(1.0));
    for (const ShapeInstance& instance : scene.instances)
      if (!instance.hidden) enclose(scene.groups[std::size_t(instance.group)].shapes, instance.to_world);
  }
  if (!(low.x <= high.x)) return;
  const double radius = std::max(0.5 * glm::length(high - low), 1e-6);
  constexpr double kFov = 40.0;
  const glm::dvec3 middle = 0.5 * (low + high);
  const glm::dvec3 away = glm::normalize(glm::dvec3(0.4, 0.3, 1.0));
  const glm::dvec3 eye = middle + 1.05 * radius / std::sin(0.5 * kFov / kDegrees) * away;
  if (const auto frame = look_at(eye, middle, glm::dvec3(0.0, 1.0, 0.0))) scene.camera.to_world = *frame;
  scene.camera.fov = kFov;
  scene.camera.fov_axis = FovAxis::kSmaller;
  scene.camera.near_clip = 1e-3 * radius;
  scene.camera.far_clip = 1e3 * radius;
}

glm::dvec3 colour_of(const tinygltf::Light& light) {
  glm::dvec3 colour(1.0);
  for (std::size_t c = 0; c < 3 && c < light.color.size(); ++c) colour[int(c)] = light.color[c];
  return colour;
}

void read_light(const Asset& asset, int light, const glm::dmat4& to_world, ReaderReport& report,
                SceneDescription& scene) {
  const SourceLocation location =
      asset.place({"extensions", "KHR_lights_punctual", "lights", std::size_t(light)});
  const tinygltf::Light& gltf = asset.model.lights[std::size_t(light)];
  PunctualLight punctual;
  if (gltf.type == "spot")
    punctual.kind = PunctualKind::kSpot;
  else if (gltf.type == "directional")
    punctual.kind = PunctualKind::kDirectional;
  else if (gltf.type != "point")
    return report.unsupported(location,
                              fmt::format("'{}' is no type of a light: point, spot, directional", gltf.type),
                              "it is left out");
  punctual.position = glm::dvec3(to_world[3]);
  punctual.direction = glm::normalize(-glm::dvec3(to_world[2]));
  const glm::dvec3 strength = colour_of(gltf) * (gltf.intensity / kLumensPerWatt);
  for (int c = 0; c < 3; ++c)
    if (!(strength[c] >= 0.0 && strength[c] < 1e37))
      return report.error(location,
                          "the colour times the intensity of a light must be at least 0 and finite");
  punctual.strength = glm::vec3(strength);
  punctual.inner_angle = gltf.spot.innerConeAngle * kDegrees;
  punctual.outer_angle = gltf.spot.outerConeAngle * kDegrees;
  // Programs write pi/2 in single precision, and twice the same angle for a sharp edge.
  constexpr double kAngleRounding = 1e-5;
  if (punctual.outer_angle > 90.0 && punctual.outer_angle < 90.0 * (1 + kAngleRounding))
    punctual.outer_angle = 90.0;
  if (punctual.inner_angle >= punctual.outer_angle &&
      punctual.inner_angle < punctual.outer_angle * (1 + kAngleRounding))
    punctual.inner_angle = punctual.outer_angle * (1 - kAngleRounding);
  if (punctual.kind == PunctualKind::kSpot &&
      !(punctual.inner_angle >= 0.0 && punctual.inner_angle < punctual.outer_angle &&
        punctual.outer_angle <= 90.0))
    return report.error(location, "a spot has 0 <= innerConeAngle < outerConeAngle <= pi/2");
  if (gltf.range > 0.0) report.warn_counted(location, "the range of lights is ignored: theirs has no end");
  add_punctual_light(punctual, scene);
}

}  // namespace penumbra::gltf
