#include "scenes/sky/sky_image.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <vector>

#include "scenes/angles.h"
#include "scenes/sky/preetham_sky.h"
#include "scenes/sky/sky_level.h"

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
    for (const glm::dvec3& texel : texels_)
      for (int c = 0; c < 3; ++c) image.words.push_back(std::bit_cast<std::uint32_t>(float(texel[c])));
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

void draw_atmosphere(const SkyImage& sky, Canvas& canvas) {
  const PreethamSky model(sky.to_sun, sky.turbidity);
  const double elevation = std::asin(std::clamp(sky.to_sun.y, 0.0, 1.0)) / kDegree;
  const glm::dvec3 level = sky.sky_scale * sky_level(sky.turbidity, elevation, sky.albedo);
  for (int y = 0; y < canvas.height(); ++y) {
    const double angle = canvas.angle_of(y) / sky.stretch;
    if (angle > kPi / 2 * (1 + 1e-9)) break;
    for (int x = 0; x < canvas.width(); ++x) {
      const double phi = 2 * kPi * (x + 0.5) / canvas.width();
      const glm::dvec3 w(std::sin(phi) * std::sin(angle), std::cos(angle), -std::cos(phi) * std::sin(angle));
      canvas.at(x, y) = level * model.radiance(w);
    }
  }
}

void draw_sun(const SkyImage& sky, Canvas& canvas) {
  const double versine = 2 * std::pow(std::sin(0.5 * kSunRadius * kDegree), 2);
  const double drawn = 2 * std::pow(std::sin(0.5 * sky.sun_radius * kDegree), 2);
  const glm::dvec3 power = sky.sun_scale * 2 * kPi * versine * sun_radiance(sky.to_sun.y, sky.turbidity);
  const glm::dvec3 other = std::abs(sky.to_sun.y) < 0.9 ? glm::dvec3(0, 1, 0) : glm::dvec3(1, 0, 0);
  const glm::dvec3 s = glm::normalize(glm::cross(sky.to_sun, other)), t = glm::cross(sky.to_sun, s);
  // Directions distributed evenly over the disk on a spiral, many per texel.
  const double texel = 2 * kPi / canvas.width();
  const int count = int(std::clamp(64 * 2 * kPi * drawn / (texel * texel), 1024.0, 4e6));
  for (int k = 0; k < count; ++k) {
    const double z = 1 - drawn * (k + 0.5) / count, r = std::sqrt(1 - z * z);
    const double phi = kPi * (3 - std::sqrt(5.0)) * k;
    canvas.add(z * sky.to_sun + r * std::cos(phi) * s + r * std::sin(phi) * t, power / double(count));
  }
}

}  // namespace

Bitmap draw_sky(const SkyImage& sky) {
  Canvas canvas(sky.width, sky.width / 2 + 1);
  if (sky.sky_scale > 0) draw_atmosphere(sky, canvas);
  if (sky.sun_scale > 0 && sky.sun_radius > 0 && sky.to_sun.y > 0) draw_sun(sky, canvas);
  return canvas.bitmap();
}

}  // namespace penumbra
