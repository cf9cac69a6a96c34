#include "scenes/device/light_bounds.h"

#include <algorithm>
#include <cmath>
#include <initializer_list>

#include "scenes/angles.h"

namespace penumbra {
namespace {

glm::dvec3 widened(const vec3& v) { return {double(v.x), double(v.y), double(v.z)}; }

/// Bounds a planar light that faces `axis`, with these vertices.
void bound_flat(LightBounds& bounds, const Light& light, const glm::dvec3& axis, double power,
                std::initializer_list<glm::dvec3> points) {
  bounds.low = bounds.high = *points.begin();
  for (const glm::dvec3& p : points) {
    bounds.low = glm::min(bounds.low, p);
    bounds.high = glm::max(bounds.high, p);
  }
  bounds.axis = axis;
  bounds.spread = 0;
  bounds.intensity = power / kPi;
  if (light.spread > 0.0f) {
    bounds.reach = std::atan(double(light.spread));
    bounds.intensity *= double(light.spread) * light.gain;  // at the normal
  }
  bounds.two_sided = light.two_sided != 0;
}

/// Computes a cone that contains both cones of axes.
void join_cones(LightBounds& all, const LightBounds& a, LightBounds b) {
  if (a.two_sided && b.two_sided && glm::dot(a.axis, b.axis) < 0) b.axis = -b.axis;
  all.axis = a.axis;
  all.spread = std::max(a.spread, b.spread);
  if (a.axis == b.axis) return;
  const glm::dvec3 normal = glm::cross(a.axis, b.axis);
  const double sine = glm::length(normal), between = std::atan2(sine, glm::dot(a.axis, b.axis));
  if (std::min(between + b.spread, kPi) <= a.spread) return;
  all.axis = b.axis;
  if (std::min(between + a.spread, kPi) <= b.spread) return;
  all.spread = 0.5 * (a.spread + between + b.spread);
  all.axis = a.axis;
  if (all.spread >= kPi || !(sine > 0)) {
    all.spread = kPi;
    return;
  }
  // The angle by which a's axis is rotated towards b's.
  const double turn = all.spread - a.spread;
  const glm::dvec3 across = glm::normalize(glm::cross(normal, a.axis));
  all.axis = glm::normalize(std::cos(turn) * a.axis + std::sin(turn) * across);
}

}  // namespace

LightBounds bounds_of_light(const Light& light, double power) {
  LightBounds bounds;
  bounds.infinite = false;
  const glm::dvec3 p0 = widened(light.p0), p1 = widened(light.p1), p2 = widened(light.p2);
  switch (light.kind) {
    case LIGHT_TRIANGLE:
    case LIGHT_RECTANGLE: {
      const glm::dvec3 normal = glm::cross(p1 - p0, p2 - p0);
      const glm::dvec3 last = light.kind == LIGHT_TRIANGLE ? p2 : p1 + p2 - p0;
      bound_flat(bounds, light, normal / std::max(glm::length(normal), 1e-300), power, {p0, p1, p2, last});
      break;
    }
    case LIGHT_DISK: {
      // Half of its extent along each coordinate axis.
      const glm::dvec3 axis = glm::normalize(p1);
      const glm::dvec3 extent = p2.x * glm::sqrt(glm::max(glm::dvec3(1.0) - axis * axis, glm::dvec3(0.0)));
      bound_flat(bounds, light, axis, power, {p0 - extent, p0 + extent});
      break;
    }
    case LIGHT_SPHERE:
      bounds.low = p0 - p2.x;
      bounds.high = p0 + p2.x;
      bounds.intensity = power / (4 * kPi);
      break;
    case LIGHT_CYLINDER: {
      const glm::dvec3 end = p0 + p2.z * p1;
      const glm::dvec3 extent = p2.x * glm::sqrt(glm::max(glm::dvec3(1.0) - p1 * p1, glm::dvec3(0.0)));
      bounds.low = glm::min(p0, end) - extent;
      bounds.high = glm::max(p0, end) + extent;
      bounds.intensity = power / (kPi * kPi);  // perpendicular to its axis
      break;
    }
    case LIGHT_POINT:
      bounds.low = bounds.high = p0;
      bounds.intensity = power / (4 * kPi);
      break;
    default: {
      LightBounds anywhere;
      anywhere.intensity = power > 0 ? 1 : 0;
      return anywhere;
    }
  }
  return bounds;
}

LightBounds bounds_between(const Light& light, const LightBounds& at_rest, const LightState& from,
                           const LightState& to) {
  const auto at = [&](const LightState& state) {
    Light there = light;
    there.p0 = state.p0;
    there.p1 = state.p1;
    there.p2 = state.p2;
    return bounds_of_light(there, 1);
  };
  LightBounds bounds = at_rest;
  auto include_axis = [&, first = true](const glm::dvec3& axis) mutable {
    const double length = glm::length(axis);
    if (!(length > 0)) return;
    LightBounds one = at_rest;
    one.axis = axis / length;
    const bool narrow = light.kind == LIGHT_TRIANGLE || light.kind == LIGHT_DISK;
    one.spread = narrow ? 0 : at_rest.spread;
    if (first)
      bounds = one;
    else
      join_cones(bounds, LightBounds(bounds), one);
    first = false;
  };
  switch (light.kind) {
    case LIGHT_TRIANGLE: {
      // The normal of a triangle whose corners move evenly is a quadratic curve, within the cone of the
      // control points of its Bezier form.
      const auto edge = [](const vec3& a, const vec3& b) { return widened(b) - widened(a); };
      const glm::dvec3 a0 = edge(from.p0, from.p1), b0 = edge(from.p0, from.p2), a1 = edge(to.p0, to.p1),
                       b1 = edge(to.p0, to.p2);
      include_axis(glm::cross(a0, b0));
      include_axis(0.5 * (glm::cross(a0, b1) + glm::cross(a1, b0)));
      include_axis(glm::cross(a1, b1));
      break;
    }
    case LIGHT_DISK:
    case LIGHT_DIRECTIONAL:
    case LIGHT_SUN:
      include_axis(widened(from.p1));
      include_axis(widened(to.p1));
      break;
    case LIGHT_SPOT:
    case LIGHT_ROUND_SPOT:
    case LIGHT_PROJECTOR:
      include_axis(widened(from.z));
      include_axis(widened(to.z));
      break;
    default:
      break;
  }
  if (at_rest.infinite) return bounds;
  const double radius = light.kind == LIGHT_ROUND_SPOT ? double(light.p2.x) : 0.0;
  for (const LightState* state : {&from, &to}) {
    const LightBounds box = is_beam_light(light.kind) ? LightBounds{.low = widened(state->p0) - radius,
                                                                    .high = widened(state->p0) + radius}
                                                      : at(*state);
    bounds.low = state == &from ? box.low : glm::min(bounds.low, box.low);
    bounds.high = state == &from ? box.high : glm::max(bounds.high, box.high);
  }
  if (light.kind == LIGHT_DISK || light.kind == LIGHT_CYLINDER) {
    // On the way the axis leans otherwise: whatever it does, it is within these distances of the centre.
    for (const LightState* state : {&from, &to}) {
      const double reach = std::hypot(double(state->p2.x), double(state->p2.z));
      bounds.low = glm::min(bounds.low, widened(state->p0) - reach);
      bounds.high = glm::max(bounds.high, widened(state->p0) + reach);
    }
  }
  return bounds;
}

LightBounds joined(const LightBounds& a, const LightBounds& b) {
  LightBounds all;
  all.low = glm::min(a.low, b.low);
  all.high = glm::max(a.high, b.high);
  join_cones(all, a, b);
  all.reach = std::max(a.reach, b.reach);
  all.intensity = a.intensity + b.intensity;
  all.two_sided = a.two_sided || b.two_sided;
  all.infinite = a.infinite;
  return all;
}

}  // namespace penumbra
