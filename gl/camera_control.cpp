#include "gl/camera_control.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>
#include <limits>
#include <numbers>
#include <span>

#include "kernels/host/bounds.h"
#include "kernels/host/device_scene.h"
#include "scenes/device/to_vec3.h"

namespace penumbra {
namespace {

using glm::dmat3;
using glm::dvec3;

constexpr double kDegree = std::numbers::pi / 180;
constexpr double kSteepest = 89.9 * kDegree;
constexpr double kLeastSine = 1e-9;  // below it two directions are parallel
// Distances whose squares single precision can represent.
constexpr double kNearest = 1e-15, kFarthest = 1e15;
constexpr double kNearestToOrigin =
    1e-6;  // of the target's distance from the origin: keeps the view's direction accurate

/// 0 for vectors of length 0; does not overflow for any finite vector.
dvec3 direction_of(const dvec3& v) {
  const double largest = std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
  if (!(largest > 0) || !std::isfinite(largest)) return dvec3(0);
  return glm::normalize(v / largest);
}

/// The component of `v` perpendicular to the unit direction `d`.
dvec3 across(const dvec3& v, const dvec3& d) { return v - glm::dot(v, d) * d; }

/// The unit direction perpendicular to the unit direction `d` that is closest to `preferred`; any one if
/// `preferred` is parallel to `d` or 0.
dvec3 unit_across(const dvec3& preferred, const dvec3& d) {
  const dvec3 perpendicular = across(preferred, d);
  if (glm::length(perpendicular) > kLeastSine)
    return glm::normalize(across(glm::normalize(perpendicular), d));
  dvec3 axis(0);
  const dvec3 size = glm::abs(d);
  axis[size.x <= size.y && size.x <= size.z ? 0 : size.y <= size.z ? 1 : 2] = 1;
  return glm::normalize(across(axis, d));
}

ViewFrame frame_of(const dvec3& forward, const dvec3& up) {
  ViewFrame frame;
  frame.forward = forward;
  frame.up = unit_across(direction_of(up), forward);
  frame.right = glm::cross(frame.forward, frame.up);
  return frame;
}

dmat3 columns(const ViewFrame& f) { return {f.right, f.up, f.forward}; }

/// Distance along the unit direction `d` to the triangle, or infinity. It is not watertight between
/// neighbours: a target's distance does not depend on a single triangle.
double distance_to(const Triangle& triangle, const dvec3& o, const dvec3& d, double near) {
  const dvec3 p0 = to_dvec3(triangle.p0), e1 = to_dvec3(triangle.p1) - p0, e2 = to_dvec3(triangle.p2) - p0;
  const dvec3 n = glm::cross(e1, e2);
  const double cosine = glm::dot(n, d);
  const double t = glm::dot(n, p0 - o) / cosine;  // not finite if the triangle is seen edge-on
  if (!(t > near) || !std::isfinite(t)) return std::numeric_limits<double>::infinity();
  const dvec3 p = o + t * d - p0;
  const double area = glm::dot(n, n);
  const double u = glm::dot(glm::cross(p, e2), n) / area, v = glm::dot(glm::cross(e1, p), n) / area;
  return u >= 0 && v >= 0 && u + v <= 1 ? t : std::numeric_limits<double>::infinity();
}

double distance_to(const Quadric& quadric, const dvec3& o, const dvec3& d, double near) {
  constexpr double kNone = std::numeric_limits<double>::infinity();
  const dvec3 to_center = to_dvec3(quadric.center) - o;
  const double radius = quadric.radius;
  if (quadric.kind == QUADRIC_DISK) {
    const dvec3 n = to_dvec3(quadric.normal);
    const double t = glm::dot(n, to_center) / glm::dot(n, d);
    return t > near && std::isfinite(t) && glm::length(t * d - to_center) <= radius ? t : kNone;
  }
  const double middle = glm::dot(to_center, d);
  const dvec3 closest = to_center - middle * d;
  const double discriminant = radius * radius - glm::dot(closest, closest);
  if (discriminant < 0) return kNone;
  const double root = std::sqrt(discriminant);
  return middle - root > near ? middle - root : middle + root > near ? middle + root : kNone;
}

}  // namespace

ViewFrame view_frame(const CameraPose& pose) {
  const dvec3 forward = direction_of(pose.at - pose.eye);
  return frame_of(forward == dvec3(0) ? dvec3(0, 0, -1) : forward, pose.up);
}

CameraPose orbit(const CameraPose& pose, double yaw, double pitch) {
  const dvec3 offset = pose.eye - pose.at;
  const double distance = glm::length(offset);
  const dvec3 axis = direction_of(pose.up);
  if (!(distance > 0) || axis == dvec3(0) || !std::isfinite(yaw) || !std::isfinite(pitch)) return pose;
  const dvec3 side = view_frame(pose).right;
  // At the pole the frame still has a side; the direction away from the axis follows from it.
  const dvec3 right = unit_across(side, axis), out = glm::cross(right, axis);
  const double height = glm::dot(offset, axis);
  const double elevation =
      std::clamp(std::atan2(height, glm::length(offset - height * axis)) + pitch, -kSteepest, kSteepest);
  const dvec3 turned = std::cos(yaw) * out + std::sin(yaw) * right;
  CameraPose result = pose;
  result.eye = pose.at + distance * (std::cos(elevation) * turned + std::sin(elevation) * axis);
  return result;
}

CameraPose move(const CameraPose& pose, double right, double up, double forward) {
  const ViewFrame frame = view_frame(pose);
  const dvec3 by = right * frame.right + up * direction_of(pose.up) + forward * frame.forward;
  const dvec3 eye = pose.eye + by, at = pose.at + by;
  for (const dvec3& p : {eye, at}) {
    if (!(glm::length(p) <= kFarthest)) return pose;
  }
  return {eye, at, pose.up};
}

CameraPose dolly(const CameraPose& pose, double factor) {
  const dvec3 offset = pose.eye - pose.at;
  const double distance = glm::length(offset);
  if (!(factor > 0) || !(distance > 0)) return pose;
  const double least = std::max(kNearest, kNearestToOrigin * glm::length(pose.at));
  // An eye that is already nearer or farther stays there.
  const double wanted =
      std::clamp(distance * factor, std::min(least, distance), std::max(kFarthest, distance));
  CameraPose result = pose;
  result.eye = pose.at + (wanted / distance) * offset;
  return result;
}

CameraPose pose_of(const SceneHeader& header, double distance) {
  constexpr double kLevel = 0.5 * kDegree;
  const dvec3 forward = direction_of(to_dvec3(header.camera.z));
  const ViewFrame film = frame_of(forward, to_dvec3(header.camera.y));
  CameraPose pose;
  pose.eye = to_dvec3(header.camera.origin);
  pose.at = pose.eye + distance * forward;
  pose.up = film.up;
  double best = std::cos(kSteepest);
  for (int axis = 0; axis < 3; ++axis) {
    for (const double sign : {1.0, -1.0}) {
      dvec3 candidate(0);
      candidate[axis] = sign;
      const double upright = glm::dot(candidate, film.up);
      if (upright <= best || std::abs(glm::dot(candidate, film.right)) > std::sin(kLevel) * upright) continue;
      best = upright;
      // `up` is tilted to where the film is exactly upright, so that the view does not turn before the user
      // turns it.
      pose.up = glm::normalize(across(candidate, film.right));
    }
  }
  return pose;
}

void set_camera(const CameraPose& pose, SceneHeader& header) {
  const ViewFrame from = frame_of(direction_of(to_dvec3(header.camera.z)), to_dvec3(header.camera.y));
  const ViewFrame to = view_frame(pose);
  const dmat3 turn = columns(to) * glm::transpose(columns(from));
  header.camera.origin = to_vec3(pose.eye);
  header.camera.x = to_vec3(turn * to_dvec3(header.camera.x));
  header.camera.y = to_vec3(turn * to_dvec3(header.camera.y));
  header.camera.z = to_vec3(to.forward);
}

bool film_is_mirrored(const SceneHeader& header) {
  return glm::dot(glm::cross(to_dvec3(header.camera.y), to_dvec3(header.camera.z)),
                  to_dvec3(header.camera.x)) < 0;
}

double scene_extent(const DeviceScene& scene) {
  const SceneHeader& h = scene.header;
  Box box;
  for (const Triangle& t : table<Triangle>(scene, h.tables.triangles)) box.include(bounds_of(t));
  for (const Quadric& q : table<Quadric>(scene, h.tables.quadrics)) box.include(bounds_of(q));
  const dvec3 size = dvec3(box.high[0], box.high[1], box.high[2]) - dvec3(box.low[0], box.low[1], box.low[2]);
  const double diagonal = glm::length(size);
  return size.x >= 0 && diagonal > 0 && std::isfinite(diagonal) ? diagonal : 1;
}

double default_distance(const DeviceScene& scene) {
  constexpr double kLeast = 1e-6;
  const SceneHeader& h = scene.header;
  const dvec3 eye = to_dvec3(h.camera.origin), forward = direction_of(to_dvec3(h.camera.z));
  const double near = std::max(0.0f, h.camera.near_clip), extent = scene_extent(scene);
  double nearest = std::numeric_limits<double>::infinity();
  for (const Triangle& t : table<Triangle>(scene, h.tables.triangles))
    nearest = std::min(nearest, distance_to(t, eye, forward, near));
  for (const Quadric& q : table<Quadric>(scene, h.tables.quadrics))
    nearest = std::min(nearest, distance_to(q, eye, forward, near));
  return std::isfinite(nearest) ? std::max(nearest, kLeast * extent) : extent;
}

double step_length(const CameraPose& pose, double extent) {
  return std::clamp(0.05 * glm::distance(pose.eye, pose.at), 1e-4 * extent, 0.1 * extent);
}

}  // namespace penumbra
