#include "scenes/sky/sky_parameters.h"

#include <fmt/format.h>

#include <cmath>
#include <memory>
#include <numbers>

#include "scenes/sky/preetham_sky.h"
#include "scenes/sky/sky_image.h"

namespace penumbra {

/// Mitsuba 3's frame has x to the south, y to the west and z up; that of version 0.6 x to the east, y up and
/// z to the south.
glm::dmat3 SkyParameters::frame() const {
  return is_z_up ? glm::dmat3(glm::dvec3(0, -1, 0), glm::dvec3(0, 0, 1), glm::dvec3(1, 0, 0))
                 : glm::dmat3(1.0);
}

void SkyParameters::check(Findings& findings, bool has_direction) {
  const auto within = [&](const char* name, double value, double low, double high) {
    if (!(value >= low && value <= high))
      findings.push_back(
          {name, fmt::format("{} must be a number in [{}, {}], not {}", name, low, high, value)});
  };
  within("latitude", latitude, -90, 90);
  within("longitude", longitude, -180, 180);
  within("timezone", timezone, -24, 24);
  within("year", year, 1, 9999);
  within("month", month, 1, 12);
  within("day", day, 1, 31);
  within("hour", hour, 0, 24);
  within("minute", minute, 0, 60);
  within("second", second, 0, 60);
  if (!findings.empty()) return;
  const double length = glm::length(sun_direction);
  if (has_direction && !(length > 0.0 && length < 1e150)) {
    findings.push_back({"sun_direction", "the direction to the sun must have a length above 0"});
    return;
  }
  to_sun_ =
      has_direction
          ? glm::transpose(frame()) * (sun_direction / length)
          : penumbra::sun_direction({latitude, longitude, timezone, year, month, day, hour, minute, second});
  if (to_sun_.y < 0)
    findings.push_back(
        {"sun_direction",
         fmt::format("the sun is {:.1f} degrees below the horizon: there is no sun, and the sky "
                     "is that of a sun at the horizon",
                     -std::asin(to_sun_.y) * 180 / std::numbers::pi),
         true});
}

Expected<SkyParameters> SkyParameters::with_sun(const SkyParameters& sun) const {
  const auto differ = [](const char* what) {
    return fail(fmt::format("sky and sun of a scene have the same {}", what));
  };
  if (turbidity != sun.turbidity) return differ("turbidity");
  if (to_world != sun.to_world) return differ("to_world");
  // Equal values may differ by rounding, in the file or in the computation.
  if (!(glm::length(to_sun_ - sun.to_sun_) < 1e-6)) return differ("sun_direction, or place and time");
  SkyParameters both = *this;
  both.sky_scale = scale * sky_scale;
  both.sun_scale = sun.scale * sun.sun_scale;
  both.scale = 1.0f;
  both.sun_radius_scale = sun.sun_radius_scale;
  both.resolution = std::max(resolution, sun.resolution);
  return both;
}

Emitter SkyParameters::emitter(SkyPart part) const {
  const glm::dmat4 placed = to_world * glm::dmat4(frame());
  if (part == SkyPart::kSun && sun_radius_scale == 0.0f) {
    DirectionalLight light;
    const double angle = 0.5 * kSunRadius * std::numbers::pi / 180;
    const double solid_angle = 4 * std::numbers::pi * std::sin(angle) * std::sin(angle);
    light.irradiance =
        glm::vec3(double(scale) * sun_scale * solid_angle * sun_radiance(to_sun_.y, turbidity));
    light.direction = -glm::dvec3(placed * glm::dvec4(to_sun_, 0));
    return light;
  }
  SkyImage sky;
  sky.width = int(resolution) / 2 * 2;
  sky.turbidity = turbidity;
  sky.albedo = glm::dvec3(albedo);
  sky.to_sun = to_sun_;
  sky.sky_scale = part == SkyPart::kSun ? 0.0 : double(scale) * sky_scale;
  sky.sun_scale = part == SkyPart::kSky ? 0.0 : double(scale) * sun_scale;
  sky.stretch = stretch;
  // A sun without a size beside a sky gets the size of a texel.
  sky.sun_radius = kSunRadius * std::max(double(sun_radius_scale), 1e-3);
  EnvironmentMapLight light;
  light.to_world = placed;
  light.image = std::make_shared<const Bitmap>(draw_sky(sky));
  return light;
}

}  // namespace penumbra
