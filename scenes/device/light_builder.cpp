#include "scenes/device/light_builder.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <set>

#include "scenes/device/light_table.h"
#include "scenes/device/to_vec3.h"

namespace penumbra {
namespace {

// The factor by which a grid must reduce the second moment of a textured light's samples. With area sampling
// the grid changes only the random numbers. The other methods choose points depending on the receiver's
// position, and a cone leaves out the half of a sphere that is not visible; a grid gives that up.
constexpr double kGainOverArea = 1.2, kGainOverSolidAngle = 2, kGainOverCone = 4;

double mean(const glm::vec3& c) { return (double(c.x) + c.y + c.z) / 3; }

int code(EmitterSampling sampling, int by_default) {
  switch (sampling) {
    case EmitterSampling::kAuto:
      return by_default;
    case EmitterSampling::kArea:
      return EMITTER_AREA;
    case EmitterSampling::kSolidAngle:
      return EMITTER_SOLID_ANGLE;
    case EmitterSampling::kProjected:
      return EMITTER_PROJECTED;
  }
  return by_default;
}

int unseen_by(const Shape& shape) {
  if (shape.unseen_emission) return UNSEEN_BY_RAYS;
  return shape.camera_sees_emission ? 0 : UNSEEN_BY_CAMERA;
}

/// Sets the cone into which the shape shines.
void set_spread(const Shape& shape, Light& light) {
  if (!shape.has_spread()) return;
  const double half = shape.emission_spread * std::numbers::pi / 360;
  light.spread = float(std::tan(half));
  light.gain = float(1 / (std::tan(half) - half));
}

double triangle_area(const LightTriangle& t) {
  const vec3 cross = cross3(sub(t.p1, t.p0), sub(t.p2, t.p0));
  return 0.5 * std::sqrt(double(cross.x) * cross.x + double(cross.y) * cross.y + double(cross.z) * cross.z);
}

using Corners = std::array<std::array<float, 3>, 3>;

/// The vertices in cyclic order, beginning with the smallest. So triangles that differ only in their first
/// vertex are equal.
Corners corners_of(const LightTriangle& t) {
  Corners corners{{{t.p0.x, t.p0.y, t.p0.z}, {t.p1.x, t.p1.y, t.p1.z}, {t.p2.x, t.p2.y, t.p2.z}}};
  Corners least = corners;
  for (int k = 1; k < 3; ++k) {
    std::ranges::rotate(corners, corners.begin() + 1);
    least = std::min(least, corners);
  }
  return least;
}

/// Each triangle as an outline of its own, if outlines are not needed.
Outlines separate(std::span<const LightTriangle> triangles) {
  Outlines result;
  std::set<Corners> seen;
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    const LightTriangle& t = triangles[i];
    if (seen.insert(corners_of(t)).second) {
      Outline& outline = result.outlines.emplace_back();
      outline.triangles = {int(i)};
      outline.loops = {{t.p0, t.p1, t.p2}};
      outline.area = triangle_area(t);
      outline.size = std::max({length3(sub(t.p1, t.p0)), length3(sub(t.p2, t.p1)), length3(sub(t.p0, t.p2))});
    } else
      result.duplicates.push_back(int(i));
  }
  return result;
}

/// If two triangles form a rectangle, makes a light whose sampling is set that rectangle. Returns whether
/// they do. Sampling a rectangle costs less than choosing one of two triangles in each lane, and its points
/// are distributed better.
bool take_whole(const Outline& outline, Light& light) {
  if (!outline.rectangle || light.sampling == EMITTER_PROJECTED) return false;
  light.kind = LIGHT_RECTANGLE;
  light.p0 = (*outline.rectangle)[0];
  light.p1 = (*outline.rectangle)[1];
  light.p2 = (*outline.rectangle)[2];
  return true;
}

}  // namespace

/// The sampling method (EMITTER_*) of a shape's triangles.
int LightBuilder::triangle_sampling(std::span<const LightTriangle> triangles, const Shape& shape) const {
  const EmitterSampling wanted = shape.sampling == EmitterSampling::kAuto ? by_default_ : shape.sampling;
  if (wanted != EmitterSampling::kAuto || receivers_.empty()) return code(wanted, EMITTER_AREA);
  const SamplingVariance variance =
      sampling_variance(triangles, merge_coplanar(triangles), shape.two_sided_emission, receivers_);
  return solid_angle_pays(variance, integrator_) ? EMITTER_SOLID_ANGLE : EMITTER_AREA;
}

bool LightBuilder::is_textured(const Shape& shape) const {
  return shape.radiance_texture != kNoTexture && textures_ != nullptr;
}

/// The factor that a grid must gain over the other method of sampling. Infinite if the user has chosen the
/// method.
double LightBuilder::least_gain(const Shape& shape, double gain) const {
  const EmitterSampling wanted = shape.sampling == EmitterSampling::kAuto ? by_default_ : shape.sampling;
  return wanted == EmitterSampling::kAuto ? gain : std::numeric_limits<double>::infinity();
}

/// Sets the light's texture. Returns the factor of the light's power.
double LightBuilder::show(const LightTexture& texture, Light& light) {
  light.texture = texture.texture;
  light.grid = texture.grid;
  light.grid_side = texture.grid_side;
  if (texture.grid >= 0) light.sampling = EMITTER_AREA;
  return texture.mean;
}

std::vector<int> LightBuilder::add_triangles(std::span<const LightTriangle> triangles, const Shape& shape,
                                             int first_triangle, bool moves) {
  const int sampling = triangle_sampling(triangles, shape);
  const bool textured = is_textured(shape), polygons = polygons_wanted_ && !textured && !shape.has_spread();
  const bool merges = !moves && (polygons || (!textured && sampling != EMITTER_PROJECTED));
  const double gain = least_gain(shape, sampling == EMITTER_AREA ? kGainOverArea : kGainOverSolidAngle);
  const Outlines merged = merges ? merge_coplanar(triangles) : separate(triangles);
  duplicates_ += int(merged.duplicates.size());
  std::vector<int> index(triangles.size(), -1);
  for (const Outline& outline : merged.outlines) {
    const int first = int(lights_.size());
    Light light{};
    light.texture = light.grid = -1;
    light.sampling = sampling;
    light.two_sided = shape.two_sided_emission ? 1 : 0;
    light.unseen = unseen_by(shape);
    set_spread(shape, light);
    light.polygon = polygons ? int(polygons_.size()) : -1;
    const bool whole = merges && !textured && take_whole(outline, light);
    if (whole) add(light, *shape.radiance, outline.area, std::numbers::pi * outline.area);
    for (const int t : outline.triangles) {
      const LightTriangle& triangle = triangles[std::size_t(t)];
      index[std::size_t(t)] = first;
      if (whole) continue;
      light.kind = LIGHT_TRIANGLE;
      light.p0 = triangle.p0;
      light.p1 = triangle.p1;
      light.p2 = triangle.p2;
      const double area = triangle_area(triangle);
      const double mean =
          textured ? show(textures_->of_triangle(shape.radiance_texture, first_triangle + t, gain), light)
                   : 1;
      index[std::size_t(t)] = add(light, *shape.radiance, area, mean * std::numbers::pi * area);
    }
    if (polygons) add_polygon(outline, shape, first, int(lights_.size()) - first);
  }
  if (!merged.duplicates.empty()) {
    std::map<Corners, int> light_of;
    for (std::size_t i = 0; i < triangles.size(); ++i)
      if (index[i] >= 0) light_of.emplace(corners_of(triangles[i]), index[i]);
    for (const int t : merged.duplicates)
      index[std::size_t(t)] = light_of.at(corners_of(triangles[std::size_t(t)]));
  }
  return index;
}

void LightBuilder::add_polygon(const Outline& outline, const Shape& shape, int first_light, int light_count) {
  Polygon polygon{};
  polygon.radiance = to_vec3(*shape.radiance);
  polygon.two_sided = shape.two_sided_emission ? 1 : 0;
  polygon.area = float(outline.area);
  polygon.size = outline.size;
  polygon.first_corner = int(corners_.size());
  for (const std::vector<vec3>& loop : outline.loops) {
    for (std::size_t k = 0; k < loop.size(); ++k) corners_.push_back({loop[k], k == 0 ? 1 : 0});
    corners_.push_back({loop.front(), 0});
  }
  polygon.corner_count = int(corners_.size()) - polygon.first_corner;
  polygon.first_light = first_light;
  polygon.light_count = light_count;
  polygons_.push_back(polygon);
}

int LightBuilder::add_quadric(Light light, const Shape& shape, double area, const Quadric& quadric) {
  light.sampling =
      code(shape.sampling == EmitterSampling::kAuto ? by_default_ : shape.sampling, EMITTER_SOLID_ANGLE);
  light.two_sided = shape.two_sided_emission && light.kind == LIGHT_DISK ? 1 : 0;
  light.unseen = unseen_by(shape);
  if (light.kind == LIGHT_DISK) set_spread(shape, light);
  light.polygon = light.texture = light.grid = -1;
  // Points on cylinders are never sampled by their texture.
  const double gain = light.kind == LIGHT_CYLINDER
                          ? std::numeric_limits<double>::infinity()
                          : least_gain(shape, light.kind == LIGHT_DISK ? kGainOverArea : kGainOverCone);
  const double mean =
      is_textured(shape) ? show(textures_->of_quadric(shape.radiance_texture, quadric, gain), light) : 1;
  return add(light, *shape.radiance, area, mean * std::numbers::pi * area);
}

int LightBuilder::add_emitter(const Emitter& emitter, const EmitterPlace& place) {
  return add(std::visit([&](const auto& e) { return e.light(place); }, emitter));
}

int LightBuilder::add(const EmitterLight& made) {
  lights_.push_back(made.light);
  power_.push_back(made.power);
  bounds_.push_back(made.bounds ? *made.bounds : bounds_of_light(made.light, made.power));
  return int(lights_.size()) - 1;
}

/// `power`: for unit radiance.
int LightBuilder::add(Light light, const glm::vec3& radiance, double area, double power) {
  light.radiance = to_vec3(radiance);
  light.area = float(area);
  return add({light, mean(radiance) * power});
}

void LightBuilder::cover(int light, std::span<const LightState> states) {
  LightBounds& bounds = bounds_[std::size_t(light)];
  const LightBounds at_rest = bounds;
  for (std::size_t k = 0; k + 1 < states.size(); ++k)
    bounds = joined(bounds, bounds_between(lights_[std::size_t(light)], at_rest, states[k], states[k + 1]));
  bounds.intensity = at_rest.intensity;
}

void LightBuilder::finish() {
  if (lights_.empty()) return;
  const auto class_of = [](const Light& light) {
    return is_infinite_light(light.kind) ? kSkies : is_point_of_light(light.kind) ? kPoints : kShapes;
  };
  std::array<double, kClasses> power{};
  for (std::size_t i = 0; i < lights_.size(); ++i) power[class_of(lights_[i])] += power_[i];
  // The power of a sky refers to a sphere around the scene, which says nothing about the light that arrives.
  const double others = power[kShapes] + power[kPoints];
  const double all = others > 0 ? others + std::min(power[kSkies], others) : power[kSkies];
  const auto present = std::ranges::count_if(power, [](double p) { return p > 0; });
  for (std::size_t i = 0; i < lights_.size() && present > 1; ++i) {
    const Class its = class_of(lights_[i]);
    const double share =
        0.5 * std::min(power[its], its == kSkies ? others : all) / all + 0.5 / double(present);
    power_[i] *= power[its] > 0 ? share / power[its] : 0.0;
  }
  cells_ = set_light_probabilities(lights_, power_, bounds_);
}

std::uint64_t LightBuilder::features() const {
  std::uint64_t features = polygons_wanted_ && !polygons_.empty() ? FEATURE_POLYGONS : 0;
  for (const Light& light : lights_) {
    const bool flat = light.kind == LIGHT_TRIANGLE || light.kind == LIGHT_RECTANGLE;
    if (flat && light.sampling == EMITTER_SOLID_ANGLE) features |= FEATURE_SOLID_ANGLE;
    if (flat && light.sampling == EMITTER_PROJECTED) features |= FEATURE_PROJECTED;
    if (light.texture >= 0) features |= FEATURE_LIGHT_TEXTURES;
    if (light.spread > 0.0f) features |= FEATURE_SPREAD;
  }
  return features;
}

std::uint32_t LightBuilder::kinds() const {
  std::uint32_t kinds = 0;
  for (const Light& light : lights_) kinds |= 1u << light.kind;
  return kinds;
}

bool LightBuilder::only_polygons() const {
  return std::ranges::all_of(lights_, [](const Light& light) { return light.polygon >= 0; });
}

bool LightBuilder::constant_if_projected() const {
  return std::ranges::all_of(lights_, [&](const Light& light) {
    const vec3 a = light.radiance, b = lights_.front().radiance;
    const bool same_colour = a.x * b.y == a.y * b.x && a.y * b.z == a.z * b.y && a.x * b.z == a.z * b.x;
    return light.polygon >= 0 && light.sampling == EMITTER_PROJECTED && same_colour;
  });
}

}  // namespace penumbra
