#include "scenes/device/light_textures.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <numbers>

#include "kernels/intersect/surface_uv.h"
#include "kernels/light/light_grid.h"
#include "kernels/texture/texture.h"
#include "scenes/device/records_view.h"

namespace penumbra {
namespace {

// The fraction of a light's points that are sampled uniformly whatever the texture, so that details missed by
// the cells' means are sampled too.
constexpr double kUniformShare = 0.1;
constexpr double kLeastMean = 1e-6;    // mean of a texture that was black at all points tested
constexpr int kMostTestPoints = 1024;  // number of test points along one direction of a light

template <typename Model>
void add_textures_of(const Model& model, std::vector<int>& textures) {
  Model::parameters([&](const char*, auto member, const auto&, const char*) {
    if constexpr (kMayBeTexture<std::remove_cvref_t<decltype(model.*member)>>)
      textures.push_back((model.*member).texture);
  });
}

}  // namespace

std::vector<int> textures_of_lights(const SceneDescription& scene) {
  std::vector<int> textures;
  for (const Shape& shape : scene.shapes)
    if (shape.radiance) textures.push_back(shape.radiance_texture);
  for (const Emitter& emitter : scene.emitters)
    std::visit([&](const auto& model) { add_textures_of(model, textures); }, emitter);
  return textures;
}

std::vector<vec3> LightTextures::values(const RecordsView& view, int texture,
                                        const std::vector<Place>& places) {
  const Scene& scene = view.scene();
  std::vector<vec3> result;
  result.reserve(places.size());
  for (std::size_t first = 0; first < places.size(); first += LANES) {
    Surfaces surfaces{};
    TextureLanes lanes;
    int textures[LANES];
    for (int j = 0; j < LANES; ++j) {
      const Place& at = places[std::min(first + std::size_t(j), places.size() - 1)];
      STORE_LANE_vec3(surfaces.p, j, at.p);
      surfaces.u[j] = at.u;
      surfaces.v[j] = at.v;
      surfaces.primitive[j] = at.primitive;
      textures[j] = texture;
    }
    // The header is not complete yet and lists no kinds, so textures of every kind are evaluated.
    eval_textures(&scene, &surfaces, textures, &lanes);
    for (int j = 0; j < LANES && first + std::size_t(j) < places.size(); ++j)
      result.push_back(LOAD_LANE_vec3(lanes.value, j));
  }
  return result;
}

glm::dvec2 LightTextures::texels_a_unit(int texture) const {
  if (texture < 0) return glm::dvec2(1.0);
  const SceneTexture& each = scene_->textures.at(std::size_t(texture));
  const TextureNode node = texture_of(each);
  glm::dvec2 own(2.0);  // the squares of a checkerboard
  if (const auto* image = std::get_if<BitmapTexture>(&each.model); image != nullptr && image->bitmap >= 0) {
    const Bitmap& bitmap = *scene_->bitmaps.at(std::size_t(image->bitmap));
    own = glm::dvec2(bitmap.width, bitmap.height);
  }
  if (const auto* noise = std::get_if<NoiseTexture>(&each.model))
    own = glm::dvec2(std::pow(double(noise->lacunarity), double(noise->octaves - 1)));
  const glm::dmat3& m = each.to_uv;
  own = glm::dvec2(std::abs(m[0][0]) * own.x + std::abs(m[0][1]) * own.y,
                   std::abs(m[1][0]) * own.x + std::abs(m[1][1]) * own.y);
  return glm::max(own, glm::max(texels_a_unit(node.texture0), texels_a_unit(node.texture1)));
}

int LightTextures::add_grid(const std::vector<double>& weights, int side) const {
  const auto add_edges = [&](auto weight) {
    double total = 0, sum = 0;
    for (int k = 0; k < side; ++k) total += weight(k);
    for (int k = 0; k <= side; ++k) {
      const double edge = k == side ? 1.0 : sum / total;
      records_->light_grids.push_back(float(std::round(edge * 0x1p24) * 0x1p-24));
      if (k < side) sum += weight(k);
    }
  };
  const auto cell = [&](int i, int k) {
    return weights[std::size_t(i) * std::size_t(side) + std::size_t(k)];
  };
  const int first = int(records_->light_grids.size());
  add_edges([&](int i) {
    double row = 0;
    for (int k = 0; k < side; ++k) row += cell(i, k);
    return row;
  });
  for (int i = 0; i < side; ++i) add_edges([&](int k) { return cell(i, k); });
  return first;
}

LightTexture LightTextures::measure(int texture, const PlaceOf& place, double across, double gain) const {
  LightTexture result;
  result.texture = places_.at(std::size_t(texture));
  const double cells = std::clamp(std::ceil(across), 1.0, double(MOST_LIGHT_GRID_SIDE));
  const int side = int(std::bit_ceil(unsigned(cells)));
  // The number of test points per cell along one direction: every texel, up to kMostTestPoints in total.
  const int looks = std::clamp(int(std::ceil(std::min(2.0 * across, double(kMostTestPoints)) / side)),
                               side < 8 ? 4 : 2, kMostTestPoints / side);
  const RecordsView view(*records_);
  std::vector<Place> at;
  std::vector<double> means(std::size_t(side) * std::size_t(side)), squares(means.size());
  double mean = 0, square = 0;
  const double per_cell = double(looks) * looks, count = double(means.size());
  for (std::size_t c = 0; c < means.size(); ++c) {
    const int i = int(c) / side, k = int(c) % side;
    at.clear();
    for (int a = 0; a < looks; ++a)
      for (int b = 0; b < looks; ++b)
        at.push_back(place((i + (a + 0.5) / looks) / side, (k + (b + 0.5) / looks) / side));
    for (const vec3& value : values(view, result.texture, at)) {
      const double sum = std::max(0.0f, value.x) + double(std::max(0.0f, value.y)) + std::max(0.0f, value.z);
      means[c] += sum / 3 / per_cell;
      squares[c] += sum * sum / 9 / per_cell;
    }
    mean += means[c] / count;
    square += squares[c] / count;
  }
  result.mean = std::max(mean, kLeastMean);
  if (!(mean > 0) || !std::isfinite(square) || side == 1) return result;
  double with_grid = 0;
  for (std::size_t c = 0; c < means.size(); ++c) {
    means[c] = (1 - kUniformShare) * means[c] / mean + kUniformShare;
    with_grid += squares[c] / means[c] / count;
  }
  if (!(square >= gain * with_grid)) return result;
  result.grid = add_grid(means, side);
  result.grid_side = side;
  return result;
}

LightTexture LightTextures::of_triangle(int texture, int triangle, double gain) const {
  const Triangle& t = records_->triangles.at(std::size_t(triangle));
  const VertexUvs& uv = records_->vertex_uvs.at(std::size_t(triangle));
  const auto extent = [](float a, float b, float c) {
    return double(std::max({a, b, c})) - double(std::min({a, b, c}));
  };
  const glm::dvec2 density = texels_a_unit(texture);
  const double across =
      std::max(density.x * extent(uv.u0, uv.u1, uv.u2), density.y * extent(uv.v0, uv.v1, uv.v2));
  const auto place = [&](double u, double v) {
    const auto root = float(std::sqrt(u)), b0 = 1.0f - root, b1 = float(v) * root, b2 = (1.0f - b0) - b1;
    const TexturePoint on = triangle_uv(&uv, b0, b1, b2);
    return Place{on.u, on.v, add(add(scale(t.p0, b0), scale(t.p1, b1)), scale(t.p2, b2)), triangle};
  };
  return measure(texture, place, across, gain);
}

LightTexture LightTextures::of_quadric(int texture, const Quadric& quadric, double gain) const {
  const glm::dvec2 density = texels_a_unit(texture);
  const bool sphere = quadric.kind == QUADRIC_SPHERE;
  const auto place = [&](double u, double v) {
    if (quadric.kind == QUADRIC_CYLINDER) return Place{float(v), float(u), quadric.center, 0};
    float sine, cosine;
    sincos_2pi(float(v), &sine, &cosine);
    const float r = quadric.radius * std::sqrt(float(u));
    const vec3 outward = sample_uniform_sphere(float(u), float(v));
    const vec3 from_center =
        sphere ? scale(outward, quadric.radius) : from_frame(quadric.normal, r * cosine, r * sine, 0.0f);
    const TexturePoint on = sphere ? sphere_uv(to_quadric_frame(quadric, outward))
                                   : disk_uv(to_quadric_frame(quadric, from_center), quadric.radius);
    return Place{on.u, on.v, add(quadric.center, from_center), 0};
  };
  return measure(texture, place, std::max(density.x, density.y), gain);
}

LightTexture LightTextures::of_image(int texture) const {
  const glm::dvec2 density = texels_a_unit(texture);
  const auto place = [](double u, double v) { return Place{float(u), float(v), make_vec3(0, 0, 0), 0}; };
  return measure(texture, place, std::max(density.x, density.y), std::numeric_limits<double>::infinity());
}

glm::ivec2 LightTextures::size_of(int texture) const {
  if (texture < 0) return {1, 1};
  const TextureModel& model = scene_->textures.at(std::size_t(texture)).model;
  if (const auto* scaled = std::get_if<ScaleTexture>(&model)) return size_of(scaled->texture);
  const auto* image = std::get_if<BitmapTexture>(&model);
  if (image == nullptr || image->bitmap < 0) return {1, 1};
  const Bitmap& bitmap = *scene_->bitmaps.at(std::size_t(image->bitmap));
  return {bitmap.width, bitmap.height};
}

}  // namespace penumbra
