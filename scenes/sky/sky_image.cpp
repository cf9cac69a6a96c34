#include "scenes/sky/sky_image.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <vector>

#include "scenes/angles.h"
#include "scenes/sky/hosek_wilkie_sky.h"
#include "scenes/sky/hosek_wilkie_sun.h"

namespace penumbra {
namespace {

/// The image while it is drawn.
class Canvas {
 public:
  Canvas(int width, int height)
      : width_(width), height_(height), texels_(std::size_t(width) * std::size_t(height), glm::dvec3(0)) {}

  [[nodiscard]] int width() const { return width_; }
  [[nodiscard]] int height() const { return height_; }
  glm::dvec3& at(int x, int y) { return texels_[std::size_t(y) * std::size_t(width_) + std::size_t(x)]; }
  [[nodiscard]] double angle_of(double y) const { return kPi * y / (height_ - 1); }

  /// Adds light from a direction, given as radiance times solid angle, to the surrounding texels.
  void add(const glm::dvec3& w, const glm::dvec3& power) {
    const double turns = std::atan2(w.x, -w.z) / (2 * kPi);
    const double column = (turns - std::floor(turns)) * width_ - 0.5;
    const double row = std::atan2(std::hypot(w.x, w.z), w.y) / kPi * (height_ - 1);
    const int x = int(std::floor(column)), y = std::clamp(int(row), 0, height_ - 2);
    for (const int i : {0, 1})
      for (const int k : {0, 1}) {
        const double share = std::abs(1 - i - (column - x)) * std::abs(1 - k - (row - y));
        at((x + i + width_) % width_, y + k) += share / solid_angle(y + k) * power;
      }
  }

  [[nodiscard]] Bitmap bitmap() const {
    Bitmap image{"sky", width_, height_, 3, TexelType::kFloat, {}};
    image.words.reserve(3 * texels_.size());
    for (const glm::dvec3& texel : texels_) {
      const bool is_dark = texel.x + texel.y + texel.z < 0;
      for (int c = 0; c < 3; ++c)
        image.words.push_back(std::bit_cast<std::uint32_t>(is_dark ? 0.0f : float(texel[c])));
    }
    return image;
  }

 private:
  /// The solid angle of a texel in row y: the integral of its bilinear hat function.
  [[nodiscard]] double solid_angle(int y) const {
    const double step = kPi / (height_ - 1), angle = angle_of(y);
    // The integral of sin over a hat of half-width h: sin(angle) (2 - 2 cos h) / h; at a pole half a hat.
    const double hat = y == 0 || y == height_ - 1 ? 1 - std::sin(step) / step
                                                  : std::sin(angle) * (2 - 2 * std::cos(step)) / step;
    return hat * 2 * kPi / width_;
  }

  int width_, height_;
  std::vector<glm::dvec3> texels_;
};

/// The fall of an extended sky's radiance below the horizon (Mitsuba 0.6), where `angle` is from the zenith.
double fade(double angle) {
  const double t = std::clamp(2 - angle / (kPi / 2), 0.0, 1.0);
  return t * t * (3 - 2 * t);
}

void draw_atmosphere(const SkyImage& sky, Canvas& canvas) {
  const HosekWilkieSky model(sky.to_sun, sky.turbidity, sky.albedo);
  const double end = sky.extend ? kPi : std::min(kPi / 2 * sky.stretch, kPi);
  const double row = canvas.angle_of(1);
  for (int y = 0; y < canvas.height(); ++y) {
    const double angle = canvas.angle_of(y);
    const double top = std::max(angle - row / 2, 0.0), bottom = std::min(angle + row / 2, kPi);
    const double share = std::min((end - top) / (bottom - top), 1.0);
    if (!(share > 0)) break;
    const double scale = sky.sky_scale * share * (sky.extend ? fade(angle) : 1.0);
    const double model_angle = std::min(angle / sky.stretch, kPi / 2);
    for (int x = 0; x < canvas.width(); ++x) {
      const double phi = 2 * kPi * (x + 0.5) / canvas.width();
      const glm::dvec3 w(std::sin(phi) * std::sin(model_angle), std::cos(model_angle),
                         -std::cos(phi) * std::sin(model_angle));
      canvas.at(x, y) += scale * model.radiance(w);
    }
  }
}

double elevation_of(const glm::dvec3& to_sun) { return std::asin(std::clamp(to_sun.y, 0.0, 1.0)); }

/// The disk is drawn with many points per texel, but at least and at most so many.
/// `plain` is its radiance where it is plain.
void draw_sun(const SkyImage& sky, const HosekWilkieSun& model, const glm::dvec3& plain, Canvas& canvas,
              double fewest = 4096.0, double most = 4e6) {
  const double radius = sky.sun_radius * kDegree;
  const glm::dvec3 to_sun = stretched(sky.to_sun, sky.stretch);
  const glm::dvec3 other = std::abs(to_sun.y) < 0.9 ? glm::dvec3(0, 1, 0) : glm::dvec3(1, 0, 0);
  const glm::dvec3 s = glm::normalize(glm::cross(to_sun, other)), t = glm::cross(to_sun, s);
  const double solid_angle = disk_solid_angle(kSunRadius * kDegree);
  const double texel = 2 * kPi / canvas.width();
  const int count = int(std::clamp(64 * disk_solid_angle(radius) / (texel * texel), fewest, most));
  for (int k = 0; k < count; ++k) {
    const glm::dvec3 d = disk_direction(k, count, radius), w = d.z * to_sun + d.x * s + d.y * t;
    const double above = kPi / 2 - std::atan2(std::hypot(w.x, w.z), w.y) / sky.stretch;
    if (above < 0) continue;
    const glm::dvec3 radiance =
        sky.complex_sun ? model.radiance(above, limb_cosine(std::hypot(d.x, d.y), radius)) : plain;
    canvas.add(w, sky.sun_scale * solid_angle / count * radiance);
  }
}

}  // namespace

glm::dvec3 stretched(const glm::dvec3& w, double factor) {
  const double level = std::hypot(w.x, w.z), angle = factor * std::atan2(level, w.y);
  if (level == 0) return {0, std::cos(angle), 0};
  return {w.x / level * std::sin(angle), std::cos(angle), w.z / level * std::sin(angle)};
}

Bitmap draw_sky(const SkyImage& sky) {
  Canvas canvas(sky.width, sky.width / 2 + 1);
  const bool is_day = sky.to_sun.y >= 0;
  if (is_day && sky.sky_scale > 0) draw_atmosphere(sky, canvas);
  if (is_day && sky.sun_scale > 0 && sky.sun_radius > 0) {
    const HosekWilkieSun model(sky.turbidity);
    draw_sun(sky, model, model.plain_radiance(elevation_of(sky.to_sun)), canvas);
  }
  return canvas.bitmap();
}

Bitmap draw_mean_sky(SkyImage sky, std::span<const glm::dvec3> of_sky, std::span<const glm::dvec3> of_sun) {
  constexpr double kFewest = 64, kMost = 512;  // points of a disk, of which there are many
  Canvas canvas(sky.width, sky.width / 2 + 1);
  sky.sky_scale /= double(of_sky.size());
  sky.sun_scale /= double(of_sun.size());
  for (const glm::dvec3& to_sun : of_sky) {
    sky.to_sun = to_sun;
    if (to_sun.y >= 0 && sky.sky_scale > 0) draw_atmosphere(sky, canvas);
  }
  const HosekWilkieSun model(sky.turbidity);
  std::vector<glm::dvec3> nodes;
  for (int node = 0; node < HosekWilkieSun::kPlainNodes; ++node) nodes.push_back(model.plain_node(node));
  for (const glm::dvec3& to_sun : of_sun) {
    sky.to_sun = to_sun;
    if (to_sun.y >= 0 && sky.sun_scale > 0)
      draw_sun(sky, model,
               HosekWilkieSun::plain_between(elevation_of(to_sun),
                                             [&](int node) { return nodes[std::size_t(node)]; }),
               canvas, kFewest, kMost);
  }
  return canvas.bitmap();
}

}  // namespace penumbra
