#include "scenes/device/device_materials.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/glm.hpp>
#include <map>
#include <variant>

#include "kernels/host/device_scene.h"
#include "scenes/mesh_tools.h"

namespace penumbra {

void set_passes(Material& m, const std::vector<Material>& before) {
  m.passing_leaves = m.passes == PASSES_NONE ? 0 : 1;
  if (m.branches == 0) return;
  const auto leaves_of = [&](int child) {
    return child < 0 ? 1 : before.at(std::size_t(child)).passing_leaves;
  };
  m.passing_leaves = leaves_of(m.first) + leaves_of(m.second);
  const auto of = [&](int child) { return child < 0 ? PASSES_ALL : before.at(std::size_t(child)).passes; };
  const bool plain = m.weight_texture == kNoTexture;
  const int first = plain && m.weight >= 1.0f ? of(m.second) : of(m.first);
  const int second = plain && m.weight <= 0.0f ? of(m.first) : of(m.second);
  m.passes = first == second ? first : PASSES_SOME;
}

void set_interior(const Bsdf& bsdf, Material& m) {
  const auto* surface = std::get_if<OpenPbrBsdf>(&bsdf.model);
  if (surface == nullptr) return;
  if (surface->walks()) m.variant |= OPENPBR_WALKS;
  if (!surface->colours_inside() || surface->attenuation) return;
  m.transmitted = {1, 1, 1};
  m.transmitted_texture = kNoTexture;
}

bool open_pane(Material& m) {
  if (m.family != FAMILY_THINDIELECTRIC) return false;
  m.family = FAMILY_CONDUCTOR;
  m.eta = {0, 0, 0};
  m.k = {1, 1, 1};
  m.pane = m.ior;
  m.passes = PASSES_SOME;
  return true;
}

bool is_glass(const std::vector<Material>& materials, int index) {
  const Material& m = materials[std::size_t(index)];
  return m.branches == 0 && m.family == FAMILY_DIELECTRIC && m.bend == BEND_NONE && !disperses(m) &&
         m.transmitted_texture == kNoTexture && std::ranges::none_of(materials, [&](const Material& other) {
           return other.branches != 0 && (other.first == index || other.second == index);
         });
}

bool has_flat_sides(const Mesh& mesh) {
  constexpr double kSteps = 1000, kLeastShare = 0.25;
  std::map<std::array<int, 3>, double> areas;
  double area = 0, largest = 0;
  for (const glm::uvec3& triangle : mesh.triangles) {
    glm::dvec3 normal = face_vector(mesh, triangle);
    const double twice = glm::length(normal);
    if (!(twice > 0)) continue;
    normal /= twice;
    const glm::dvec3 size = glm::abs(normal);
    const int axis = size.x > size.y ? (size.x > size.z ? 0 : 2) : (size.y > size.z ? 1 : 2);
    if (normal[axis] < 0) normal = -normal;
    const auto cell = [&](double x) { return int(std::lround(x * kSteps)); };
    area += twice;
    largest = std::max(largest, areas[{cell(normal.x), cell(normal.y), cell(normal.z)}] += twice);
  }
  return area > 0 && largest >= kLeastShare * area;
}

bool mark_flat_glass(const Shape& shape, std::vector<Material>& materials) {
  const int sides[] = {material_index(shape.front_bsdf), material_index(shape.back_bsdf)};
  const auto* mesh = std::get_if<Mesh>(&shape.geometry);
  const bool glass = std::ranges::all_of(sides, [&](int side) { return is_glass(materials, side); });
  if (mesh == nullptr || !glass || !has_flat_sides(*mesh)) return false;
  for (const int side : sides) materials[std::size_t(side)].flat_glass = 1;
  return true;
}

float bend_step(const SceneDescription& scene, int texture) {
  const SceneTexture& heights = scene.textures.at(std::size_t(texture));
  const auto* image = std::get_if<BitmapTexture>(&heights.model);
  if (image == nullptr || image->bitmap < 0) return kBendStep;
  const Bitmap& bitmap = *scene.bitmaps.at(std::size_t(image->bitmap));
  const double along_u = glm::length(glm::dvec2(heights.to_uv[0])),
               along_v = glm::length(glm::dvec2(heights.to_uv[1]));
  constexpr double kLeast = 1.0 / (1 << 16);  // 250 times the rounding error of coordinates
  return float(std::max(
      kLeast, 1 / (32.0 * std::max({1.0, along_u, along_v}) * std::max(bitmap.width, bitmap.height))));
}

bool has_narrow_lobes(const std::vector<Material>& materials) {
  constexpr float kBroad = 0.3f;
  return std::ranges::any_of(materials, [](const Material& m) {
    const bool disneys =
        m.family == FAMILY_PRINCIPLED || m.family == FAMILY_DISNEY || m.family == FAMILY_OPENPBR;
    const float rough = std::sqrt(m.alpha_u * m.alpha_v);
    const float alpha = disneys ? std::max(m.roughness * m.roughness, LEAST_ALPHA) : rough;
    return (ltc_families() >> m.family & 1u) != 0u && alpha > 0 && alpha < kBroad;
  });
}

}  // namespace penumbra
