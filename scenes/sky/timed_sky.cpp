#include "scenes/sky/timed_sky.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>

#include "scenes/sky/sky_image.h"
#include "scenes/sky/sky_parameters.h"

namespace penumbra {
namespace {

/// Texels over a whole turn: for one instant as sunsky has them; a mean is smoother.
constexpr int kWidthAtOnce = 2048, kWidthOfMean = 512;
/// Positions of the sun for the mean of the sky, which changes slowly, and of its own disk.
constexpr int kSkies = 256, kSuns = 8192;

}  // namespace

void TimedSkyEmitter::check(Findings& findings) const {
  const auto within = [&](const char* name, double value, double low, double high) {
    check_within(findings, name, value, low, high);
  };
  within("latitude", latitude, -90, 90);
  within("longitude", longitude, -180, 180);
  within("timezone", timezone, -24, 24);
  within("window_start_time", window_start_time, 0, 24);
  within("window_end_time", window_end_time, 0, 24);
  within("start_year", start_year, 1, 9999);
  within("start_month", start_month, 1, 12);
  within("start_day", start_day, 1, 31);
  within("end_year", end_year, 1, 9999);
  within("end_month", end_month, 1, 12);
  within("end_day", end_day, 1, 31);
  if (!findings.empty()) return;
  if (window_start_time > window_end_time)
    findings.push_back({"window_end_time", "window_end_time must not be before window_start_time"});
  if (day_number(start_year, start_month, start_day) > day_number(end_year, end_month, end_day))
    findings.push_back({"end_day", "the last day must not be before the first"});
  if (!(shutter_close > shutter_open))
    findings.push_back({"shutter_close", "shutter_close must be after shutter_open"});
}

double TimedSkyEmitter::days() const {
  return std::max(day_number(end_year, end_month, end_day) - day_number(start_year, start_month, start_day),
                  1.0);
}

glm::dvec3 TimedSkyEmitter::at(double day, double hour) const {
  return sun_direction({latitude, longitude, timezone, start_year, start_month, start_day + day, hour, 0, 0});
}

glm::dvec3 TimedSkyEmitter::to_sun(double time) const {
  const double day = (time - shutter_open) / (shutter_close - shutter_open) * (days() - 0x1p-24);
  return at(std::floor(day),
            window_start_time + (window_end_time - window_start_time) * (day - std::floor(day)));
}

std::vector<glm::dvec3> TimedSkyEmitter::suns(double open, double close, int count) const {
  const double spanned = (close - open) / (shutter_close - shutter_open) * days();
  std::vector<glm::dvec3> result;
  for (int k = 0; k < count; ++k) {
    const double time = open + (close - open) * (k + 0.5) / count;
    if (spanned < 2) {
      result.push_back(to_sun(time));
      continue;
    }
    // The days in order, and the hours by the golden ratio's multiples, which are even however few they are.
    const double day = std::floor((time - shutter_open) / (shutter_close - shutter_open) * days());
    const double share = (k + 0.5) * (std::numbers::phi - 1);
    result.push_back(
        at(day, window_start_time + (window_end_time - window_start_time) * (share - std::floor(share))));
  }
  return result;
}

EnvironmentMapLight TimedSkyEmitter::emitter(double open, double close) const {
  const bool is_mean = close > open;
  SkyImage sky;
  sky.width = is_mean ? kWidthOfMean : kWidthAtOnce;
  sky.turbidity = turbidity;
  sky.albedo = glm::dvec3(albedo);
  sky.sky_scale = sky_scale;
  sky.sun_scale = sun_scale;
  sky.sun_radius = double(sun_aperture) / 2;
  sky.complex_sun = complex_sun;
  EnvironmentMapLight light;
  light.to_world = to_world * glm::dmat4(sky_frame_with_z_up());
  light.has_wide_gamut = true;
  if (is_mean) {
    light.image = std::make_shared<const Bitmap>(
        draw_mean_sky(sky, suns(open, close, kSkies), suns(open, close, kSuns)));
  } else {
    sky.to_sun = to_sun(open);
    light.image = std::make_shared<const Bitmap>(draw_sky(sky));
  }
  return light;
}

}  // namespace penumbra
