#include "scenes/sky/sky_parameters.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "scenes/angles.h"
#include "scenes/sky/hosek_wilkie_sun.h"
#include "scenes/sky/sky_image.h"

namespace penumbra {

/// That of version 0.6 has x to the east, y up and z to the south.
glm::dmat3 SkyParameters::frame() const { return is_version_3 ? sky_frame_with_z_up() : glm::dmat3(1.0); }

void SkyParameters::check(Findings& findings, bool has_direction) {
  const auto within = [&](const char* name, double value, double low, double high) {
    check_within(findings, name, value, low, high);
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
  if (has_direction) {
    const glm::dvec3 local = glm::inverse(glm::dmat3(to_world)) * (sun_direction / length);
    to_sun_ = glm::transpose(frame()) * glm::normalize(local);
  } else {
    to_sun_ =
        penumbra::sun_direction({latitude, longitude, timezone, year, month, day, hour, minute, second});
  }
  if (to_sun_.y < 0)
    findings.push_back(
        {"sun_direction",
         fmt::format("the sun is {:.1f} degrees below the horizon, and the models have no night{}",
                     -std::asin(to_sun_.y) / kDegree, is_version_3 ? ": all is black" : ""),
         is_version_3});
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
  both.sun_scale = sun.sun_scale;
  both.complex_sun = sun.complex_sun;
  both.sun_radius_scale = sun.sun_radius_scale;
  both.resolution = std::max(resolution, sun.resolution);
  return both;
}

std::vector<Emitter> SkyParameters::emitters(SkyPart part) const {
  std::vector<Emitter> made;
  const glm::dmat4 placed = to_world * glm::dmat4(frame());
  const bool has_disk = sun_radius_scale > 0.0f;
  if (has_disk || part != SkyPart::kSun) {
    SkyImage sky;
    sky.width = int(resolution) / 2 * 2;
    sky.turbidity = turbidity;
    sky.albedo = glm::dvec3(albedo);
    sky.to_sun = to_sun_;
    sky.sky_scale = part == SkyPart::kSun ? 0.0 : double(sky_scale);
    sky.sun_scale = part == SkyPart::kSky ? 0.0 : double(sun_scale);
    sky.stretch = stretch;
    sky.extend = extend;
    sky.sun_radius = kSunRadius * double(sun_radius_scale);
    sky.complex_sun = complex_sun;
    EnvironmentMapLight light;
    light.to_world = placed;
    light.has_wide_gamut = is_version_3;  // version 0.6 clamps
    light.image = std::make_shared<const Bitmap>(draw_sky(sky));
    made.emplace_back(std::move(light));
  }
  if (!has_disk && part != SkyPart::kSky && to_sun_.y >= 0.0) {
    DirectionalLight light;
    const double elevation = std::asin(std::min(to_sun_.y, 1.0));
    const double irradiance =
        double(sun_scale) * disk_solid_angle(kSunRadius * kDegree) * HosekWilkieSun::visible_share(elevation);
    light.irradiance = glm::max(irradiance * HosekWilkieSun(turbidity).mean_radiance(elevation), 0.0);
    light.direction = -glm::dvec3(placed * glm::dvec4(stretched(to_sun_, stretch), 0));
    made.emplace_back(light);
  }
  return made;
}

}  // namespace penumbra
