// Converts spot lights and projectors to records; see kernels/light/delta_lights.h.
#include "scenes/device/beam_lights.h"

#include <algorithm>
#include <cmath>

#include "scenes/angles.h"
#include "scenes/device/light_textures.h"
#include "scenes/emitters.h"
#include "scenes/transform.h"
#include "scenes/view_angle.h"

namespace penumbra {
namespace {

/// A light at the transform's origin. With intensity `colour` its power is `power_of_one` times the colour's
/// mean.
EmitterLight beam_light(int kind, const TexturedColour& texture, const glm::vec3& colour, double power_of_one,
                        const Beam& beam, const glm::dmat4& to_world, const EmitterPlace& place) {
  LightTexture shown;
  if (texture.texture != kNoTexture) shown = place.textures->of_image(texture.texture);
  EmitterLight made = emitter_light(kind, colour * texture.value, power_of_one * shown.mean);
  made.light.texture = shown.texture;
  made.light.p0 = place.local(glm::dvec3(to_world[3]) / to_world[3].w);
  made.light.beam = int(place.records.beams.size());
  place.records.beams.push_back(beam);
  return made;
}

/// Bounds of a light that shines with `intensity` within `angle` of its axis, and not beyond.
LightBounds beam_bounds(const EmitterLight& made, const glm::dmat4& to_world, double angle,
                        double intensity) {
  constexpr double kMargin = 1e-3;  // allows for rounding
  LightBounds bounds;
  bounds.infinite = false;
  bounds.low = bounds.high = glm::dvec3(made.light.p0.x, made.light.p0.y, made.light.p0.z);
  bounds.axis = glm::normalize(glm::dvec3(to_world[2]));
  bounds.spread = std::min(angle, kPi);
  bounds.reach = kMargin;
  bounds.intensity = intensity;
  return bounds;
}

}  // namespace

Beam beam_frame(const glm::dmat4& to_world) {
  const glm::dvec3 z = glm::normalize(glm::dvec3(to_world[2])), given(to_world[0]);
  const glm::dvec3 x = glm::normalize(given - glm::dot(given, z) * z);
  Beam beam{};
  beam.x = to_vec3(x);
  beam.y = to_vec3((is_mirror(to_world) ? -1.0 : 1.0) * glm::cross(z, x));
  beam.z = to_vec3(z);
  return beam;
}

void set_light_state(const Emitter& emitter, const std::function<vec3(const glm::dvec3&)>& local,
                     LightState& state) {
  const auto set_beam = [&](const glm::dmat4& to_world) {
    const Beam beam = beam_frame(to_world);
    state.p0 = local(glm::dvec3(to_world[3]) / to_world[3].w);
    state.x = beam.x;
    state.y = beam.y;
    state.z = beam.z;
  };
  if (const auto* point = std::get_if<PointLight>(&emitter)) state.p0 = local(point->position);
  if (const auto* sun = std::get_if<DirectionalLight>(&emitter))
    state.p1 = to_vec3(glm::normalize(sun->direction));
  if (const auto* spot = std::get_if<SpotLight>(&emitter)) {
    set_beam(spot->to_world);
    state.p2 = make_vec3(float(spot->radius), 1.0f, 0.0f);
  }
  if (const auto* projector = std::get_if<ProjectorLight>(&emitter)) set_beam(projector->to_world);
  if (const auto* map = std::get_if<EnvironmentMapLight>(&emitter)) {
    const auto axis = [&](int i) { return to_vec3(glm::normalize(glm::dvec3(map->to_world[i]))); };
    state.p0 = axis(0);
    state.p1 = axis(1);
    state.p2 = axis(2);
  }
}

EmitterLight SpotLight::light(const EmitterPlace& place) const {
  const double beam_angle = beam_width * kPi / 180, cutoff = cutoff_angle * kPi / 180;
  const auto versine = [](double angle) { return 2 * std::sin(0.5 * angle) * std::sin(0.5 * angle); };
  const bool of_cosine = falloff != SpotFalloff::kLinear;
  const double from = of_cosine ? versine(beam_angle) : beam_angle, to = of_cosine ? versine(cutoff) : cutoff;
  Beam beam = beam_frame(to_world);
  beam.falloff = int(falloff);
  beam.beam_width = float(from);
  beam.cutoff = float(to);
  beam.inverse_width = beam.cutoff > beam.beam_width ? 1.0f / (beam.cutoff - beam.beam_width) : 0.0f;
  if (texture.texture != kNoTexture) beam.u_by_x = beam.v_by_y = float(0.5 / std::tan(cutoff));
  // The integral of the falloff over all directions. Between `from` and `to` the cubic has mean 1/2 and the
  // square mean 1/3. The linear falloff (cutoff - angle) / (cutoff - beam) is integrated by parts.
  const double linear = to > from ? 1 - (std::sin(to) - std::sin(from)) / (to - from) : versine(cutoff);
  const double solid_angle = 2 * kPi *
                             (falloff == SpotFalloff::kSmoothstep ? 0.5 * (from + to)
                              : falloff == SpotFalloff::kSquared  ? from + (to - from) / 3
                                                                  : linear);
  EmitterLight made = beam_light(LIGHT_SPOT, texture, intensity, solid_angle, beam, to_world, place);
  made.bounds = beam_bounds(made, to_world, cutoff, made.power / std::max(solid_angle, 1e-30));
  if (radius > 0) {
    made.light.kind = LIGHT_ROUND_SPOT;
    made.light.sampling = EMITTER_SOLID_ANGLE;
    made.light.p2 = make_vec3(float(radius), 1.0f, 0.0f);
    made.light.area = float(4 * kPi * radius * radius);
    made.bounds->low -= radius;
    made.bounds->high += radius;
  }
  return made;
}

EmitterLight ProjectorLight::light(const EmitterPlace& place) const {
  const bool image = irradiance.texture != kNoTexture;
  const glm::ivec2 size = image ? place.textures->size_of(irradiance.texture) : glm::ivec2(1);
  const double x = half_width_tangent(fov, fov_axis, size.x, size.y), y = x * size.y / size.x;
  Beam beam = beam_frame(to_world);
  beam.u_by_x = float(-0.5 / x);
  beam.v_by_y = float(-0.5 / y);
  // Irradiance pi on the plane at distance 1.
  const double area = 4 * x * y;
  EmitterLight made =
      beam_light(LIGHT_PROJECTOR, irradiance, glm::vec3(scale), kPi * area, beam, to_world, place);
  // The intensity is highest in the corners: see projector_light_radiance.
  const double corner = std::hypot(x, y), inverse_cosine = std::sqrt(1 + corner * corner);
  made.bounds =
      beam_bounds(made, to_world, std::atan(corner), made.power / area * std::pow(inverse_cosine, 3));
  return made;
}

}  // namespace penumbra
