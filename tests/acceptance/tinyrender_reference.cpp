#include "tests/acceptance/tinyrender_reference.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "scheduler/image/image.h"
#include "tests/acceptance/shadowed_polygon.h"
#include "tests/support/statistics.h"

namespace penumbra {
namespace {

using glm::dvec3;

std::array<dvec3, 3> corners(const Mesh& mesh, const glm::uvec3& triangle, const dvec3& from) {
  return {mesh.positions[triangle.x] - from, mesh.positions[triangle.y] - from,
          mesh.positions[triangle.z] - from};
}

double area(const Mesh& mesh) {
  double sum = 0;
  for (const glm::uvec3& triangle : mesh.triangles) {
    const auto [a, b, c] = corners(mesh, triangle, dvec3(0));
    sum += glm::length(glm::cross(b - a, c - a)) / 2;
  }
  return sum;
}

/// Adds up one block, or the whole.
struct Sums {
  double values = 0, squares = 0, signs = 0, count = 0;
  void add(double difference) {
    values += difference;
    squares += difference * difference;
    signs += difference > 0 ? 1 : -1;
    count += 1;
  }
  [[nodiscard]] double z() const { return values / std::sqrt(squares); }
  [[nodiscard]] double sign_z() const { return signs / std::sqrt(count); }
};

void add_block(SymmetryTest::Part& part, double z, int x, int y) {
  part.blocks += 1;
  part.mean_square += z * z;
  if (std::abs(z) <= std::abs(part.worst)) return;
  part.worst = z;
  part.worst_x = x, part.worst_y = y;
}

std::string failure_of(const SymmetryTest::Part& part, const char* what, double significance) {
  const auto limit = [&](double tests) { return std::sqrt(2 * std::log(2 * tests / significance)); };
  const double blocks = double(part.blocks);
  // The sum of many z^2 is normally distributed.
  const double spread = statistics::sidak_limit(significance, 1) * std::sqrt(2 / blocks);
  std::string result;
  if (!(blocks >= 30)) result += fmt::format("only {} blocks have any {}; ", part.blocks, what);
  if (!(std::abs(part.worst) < limit(blocks)))
    result += fmt::format("a block's {} have |z| >= {:.2f}; ", what, limit(blocks));
  if (!(std::abs(part.mean_square - 1) < spread))
    result += fmt::format("the mean z^2 of the {} is not within {:.3f} of 1; ", what, spread);
  if (!(std::abs(part.whole) < limit(1)))
    result += fmt::format("all {} together have |z| >= {:.2f}; ", what, limit(1));
  return result;
}

}  // namespace

statistics::Image read_reference(const std::filesystem::path& file) {
  const auto image = read_image(file);
  if (!image) throw std::runtime_error(image.error().message);
  const auto channels = image->beauty_channels();
  if (!channels) throw std::runtime_error(file.string() + " has no colour channels");
  statistics::Image result(image->data.width, image->data.height, 3);
  for (int y = 0; y < result.height; ++y)
    for (int x = 0; x < result.width; ++x)
      for (int c = 0; c < 3; ++c) result.at(x, y, c) = image->at(x, y, (*channels)[std::size_t(c)]);
  return result;
}

void sample_pixel_centres(SceneDescription& scene) {
  scene.film.filter = FilterKind::kBox;
  scene.film.filter_radius = 1e-6f;
}

void make_emitters_spheres_chosen_alike(SceneDescription& scene) {
  double power = 0;
  for (const Shape& shape : scene.shapes)
    if (shape.radiance)
      power = std::max(power, double(shape.radiance->r) * area(std::get<Mesh>(shape.geometry)));
  for (Shape& shape : scene.shapes) {
    if (!shape.radiance) continue;
    const Mesh& mesh = std::get<Mesh>(shape.geometry);
    const double surface = area(mesh), red = shape.radiance->r, rest = power / surface - red;
    dvec3 low = mesh.positions[0], high = low;
    for (const dvec3& position : mesh.positions)
      low = glm::min(low, position), high = glm::max(high, position);
    shape.geometry =
        Sphere{.center = (low + high) / 2.0, .radius = std::sqrt(surface / (4 * std::numbers::pi))};
    shape.radiance = glm::vec3(red, rest / 2, rest / 2);
    shape.sampling = EmitterSampling::kSolidAngle;
  }
}

dvec3 PinholeCamera::floor_point(int x, int y) const {
  const dvec3 forward = glm::normalize(target - eye);
  const dvec3 right = glm::normalize(glm::cross(forward, dvec3(0, 1, 0))), up = glm::cross(right, forward);
  const double half = std::tan(fov / 360 * std::numbers::pi);
  const double u = (2 * (x + 0.5) / width - 1) * half * width / height,
               v = (1 - 2 * (y + 0.5) / height) * half;
  const dvec3 direction = forward + u * right + v * up;
  return eye - eye.y / direction.y * direction;
}

double unshadowed_radiance(const Shape& light, double albedo, const dvec3& point, int channel) {
  const Mesh& mesh = std::get<Mesh>(light.geometry);
  double sum = 0;
  for (const glm::uvec3& triangle : mesh.triangles) {
    const auto [a, b, c] = corners(mesh, triangle, point);
    sum += projected_solid_angle({a, b, c});
  }
  return albedo / std::numbers::pi * (*light.radiance)[channel] * sum;
}

double edge_error(const Shape& light, const dvec3& point,
                  const std::function<double(double)>& error_of_angle) {
  const Mesh& mesh = std::get<Mesh>(light.geometry);
  // An edge of the outline is one triangle's alone.
  std::vector<std::array<unsigned, 2>> edges;
  for (const glm::uvec3& t : mesh.triangles)
    for (const std::array<unsigned, 2>& edge :
         {std::array{t.x, t.y}, std::array{t.y, t.z}, std::array{t.z, t.x}}) {
      const auto other = std::ranges::find(edges, std::array{edge[1], edge[0]});
      if (other == edges.end())
        edges.push_back(edge);
      else
        edges.erase(other);
    }
  double sum = 0;
  for (const auto& [from, to] : edges) {
    const dvec3 a = mesh.positions[from] - point, b = mesh.positions[to] - point, cross = glm::cross(a, b);
    const double sine = glm::length(cross);
    sum += std::abs(cross.y) / sine * error_of_angle(std::atan2(sine, glm::dot(a, b)));
  }
  return sum;
}

double half_spacing(double value) {
  int exponent = 0;
  std::frexp(value, &exponent);  // value = m 2^exponent, 0.5 <= |m| < 1
  return std::ldexp(1.0, std::max(exponent - 11, -24));
}

double to_half(double value) { return std::nearbyint(value / half_spacing(value)) * half_spacing(value); }

double srgb_code(double value) {
  const double x = std::clamp(value, 0.0, 1.0);
  return 255 * (x <= 0.0031308 ? 12.92 * x : 1.055 * std::pow(x, 1 / 2.4) - 0.055);
}

Mask emitter_pixels(const FilmAccumulator& film) {
  Mask result;
  for (int y = 0; y < film.height(); ++y)
    for (int x = 0; x < film.width(); ++x) {
      const double albedo = film.layer(x, y, LAYER_ALBEDO) + film.layer(x, y, LAYER_ALBEDO, 1) +
                            film.layer(x, y, LAYER_ALBEDO, 2);
      result.push_back(film.layer(x, y, LAYER_DEPTH) > 0 && albedo == 0);
    }
  return result;
}

Mask smooth_pixels(const FilmAccumulator& film, const Mask& shines) {
  const int width = film.width(), height = film.height();
  const auto differ = [&](int x, int y, int other_x, int other_y) {
    for (const int layer : {LAYER_ALBEDO, LAYER_NORMAL})
      for (int c = 0; c < 3; ++c)
        if (std::abs(film.layer(x, y, layer, c) - film.layer(other_x, other_y, layer, c)) > 1e-3) return true;
    return (film.layer(x, y, LAYER_DEPTH) > 0) != (film.layer(other_x, other_y, LAYER_DEPTH) > 0) ||
           shines[std::size_t(y * width + x)] != shines[std::size_t(other_y * width + other_x)];
  };
  Mask result(std::size_t(width) * std::size_t(height), 1);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      for (int other_y = std::max(0, y - 1); other_y <= std::min(height - 1, y + 1); ++other_y)
        for (int other_x = std::max(0, x - 1); other_x <= std::min(width - 1, x + 1); ++other_x)
          if (differ(x, y, other_x, other_y)) result[std::size_t(y * width + x)] = 0;
  return result;
}

SymmetryTest symmetry_test(const statistics::Image& reference, const statistics::Image& ours, int channel,
                           const Mask& mask, int block, const std::function<double(int, int)>& ignored) {
  SymmetryTest test;
  Sums whole;
  double total = 0;
  for (int corner_y = 0; corner_y < reference.height; corner_y += block) {
    for (int corner_x = 0; corner_x < reference.width; corner_x += block) {
      Sums sums;
      for (int y = corner_y; y < std::min(corner_y + block, reference.height); ++y)
        for (int x = corner_x; x < std::min(corner_x + block, reference.width); ++x) {
          if (!mask[std::size_t(y) * std::size_t(reference.width) + std::size_t(x)]) continue;
          const double truth = reference.at(x, y, channel), difference = truth - ours.at(x, y, channel);
          total += truth;
          if (std::abs(difference) <= ignored(x, y)) continue;
          sums.add(difference);
          whole.add(difference);
        }
      if (sums.count == 0) continue;
      add_block(test.values, sums.z(), corner_x, corner_y);
      add_block(test.signs, sums.sign_z(), corner_x, corner_y);
    }
  }
  for (SymmetryTest::Part* part : {&test.values, &test.signs}) part->mean_square /= double(part->blocks);
  test.values.whole = whole.z();
  test.signs.whole = whole.sign_z();
  test.relative = whole.values / total;
  test.relative_error = std::sqrt(whole.squares) / total;
  test.pixels = std::size_t(whole.count);
  return test;
}

std::string SymmetryTest::failure(double significance, bool with_signs) const {
  return failure_of(values, "differences", significance) +
         (with_signs ? failure_of(signs, "signs", significance) : "");
}

std::string SymmetryTest::summary() const {
  const auto part = [](const Part& p) {
    return fmt::format("mean z^2 {:.3f}, worst z {:.2f} at ({}, {}), whole z {:.2f}", p.mean_square, p.worst,
                       p.worst_x, p.worst_y, p.whole);
  };
  return fmt::format("{} pixels in {} blocks; values: {}; signs: {}; mean off by {:.5f} +- {:.5f}", pixels,
                     values.blocks, part(values), part(signs), relative, relative_error);
}

}  // namespace penumbra
