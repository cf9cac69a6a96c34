#include "scenes/interiors.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "scenes/bsdfs/half_space.h"

namespace penumbra {
namespace {

Interior walk_inside(const OpenPbrBsdf& surface) {
  Interior inside;
  inside.walks = true;
  inside.by_colour = surface.subsurface_color.texture != kNoTexture;
  const glm::vec3 radius = surface.subsurface_radius * surface.subsurface_radius_scale;
  const float least = 1e-6f * std::max({radius.x, radius.y, radius.z});
  for (int c = 0; c < 3; ++c) {
    inside.medium.extinction[c] = 1.0f / std::max({radius[c], least, 1e-30f});
    inside.medium.albedo[c] = inside.by_colour
                                  ? 1.0f
                                  : float(half_space(surface.subsurface_anisotropy)
                                              .single_albedo(double(surface.subsurface_color.value[c])));
  }
  inside.medium.phase = {{PHASE_HG, surface.subsurface_anisotropy, 1.0f}};
  return inside;
}

Interior coloured_inside(const OpenPbrBsdf& surface) {
  Interior inside;
  glm::vec3 absorbed(0.0f);
  const glm::vec3 scattered = surface.transmission_scatter / surface.transmission_depth;
  for (int c = 0; c < 3; ++c) {
    // Black colours have the extinction of 1e-6.
    const glm::vec3 given = surface.attenuation.value_or(surface.transmission_color.value);
    const float colour = std::max(given[c], 1e-6f);
    absorbed[c] = std::max(-std::log(colour), 0.0f) / surface.transmission_depth - scattered[c];
  }
  absorbed -= std::min({absorbed.x, absorbed.y, absorbed.z, 0.0f});
  inside.medium.extinction = absorbed + scattered;
  for (int c = 0; c < 3; ++c) {
    const float extinction = inside.medium.extinction[c];
    inside.medium.albedo[c] = extinction > 0.0f ? std::min(scattered[c] / extinction, 1.0f) : 0.0f;
  }
  inside.medium.phase = {{PHASE_HG, surface.transmission_anisotropy, 1.0f}};
  return inside;
}

}  // namespace

std::optional<Interior> interior_of(const SceneDescription& scene, int bsdf) {
  if (bsdf < 0) return std::nullopt;
  const Bsdf& own = scene.bsdfs[std::size_t(bsdf)];
  if (const auto* blend = std::get_if<BlendBsdf>(&own.model)) {
    auto first = interior_of(scene, blend->first);
    return first ? first : interior_of(scene, blend->second);
  }
  if (const auto* mask = std::get_if<MaskBsdf>(&own.model)) return interior_of(scene, mask->inside);
  if (own.inside) {
    Interior inside;
    inside.medium = {.name = own.name,
                     .extinction = own.inside->extinction,
                     .albedo = own.inside->albedo,
                     .phase = {{PHASE_HG, own.inside->g, 1.0f}},
                     .of_material = true};
    return inside;
  }
  const auto* surface = std::get_if<OpenPbrBsdf>(&own.model);
  if (surface == nullptr || surface->inside || !(surface->walks() || surface->colours_inside()))
    return std::nullopt;
  Interior inside = surface->walks() ? walk_inside(*surface) : coloured_inside(*surface);
  inside.medium.name = own.name;
  inside.medium.of_material = true;
  return inside;
}

std::vector<std::string> interior_warnings(const SceneDescription& scene) {
  std::vector<std::string> warnings;
  for (const Bsdf& bsdf : scene.bsdfs) {
    const auto* surface = std::get_if<OpenPbrBsdf>(&bsdf.model);
    const auto warn = [&](const char* what) {
      warnings.push_back(fmt::format("{}: {}: {}", scene.source, bsdf.name, what));
    };
    if (bsdf.inside && !sees_interiors(scene.integrator))
      warn("this integrator ignores what is inside; path and volpath do not");
    if (surface == nullptr || surface->inside) continue;
    if (surface->scatters_below() && surface->transmits() && !surface->thin_walled)
      warn("where a surface also transmits, what scatters below it is reflected diffusely");
    if (surface->colours_inside() && !surface->attenuation &&
        surface->transmission_color.texture != kNoTexture)
      warn("a transmission_color with a depth has no texture; its factor is used");
    if (sees_interiors(scene.integrator)) continue;
    if (surface->walks())
      warn("this integrator reflects what scatters below the surface diffusely; path and volpath follow it");
    if (surface->colours_inside())
      warn(surface->attenuation
               ? "this integrator ignores what glass absorbs; path and volpath do not"
               : "this integrator colours what is transmitted at the surface; path and volpath do so inside");
  }
  return warnings;
}

}  // namespace penumbra
