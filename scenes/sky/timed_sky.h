// Mitsuba 3.7's timed_sunsky: the mean of sky and sun over the hours of days, which becomes an environment
// map.
#pragma once

#include <glm/glm.hpp>
#include <variant>
#include <vector>

#include "scenes/emitters.h"
#include "scenes/plugin_values.h"
#include "scenes/sky/hosek_wilkie_sun.h"
#include "scenes/sky/sun_position.h"

namespace penumbra {

struct TimedSkyEmitter {
  static constexpr bool kIsSky = true;
  static constexpr const char* kPlugin = "timed_sunsky";
  static constexpr const char* kText =
      "clear sky and sun, their mean while the sensor's shutter is open, of version 3.7; the frame is that "
      "of "
      "sunsky";
  float turbidity = 3.0f;
  glm::vec3 albedo{0.3f};
  float sky_scale = 1.0f, sun_scale = 1.0f;
  float sun_aperture = float(2 * kSunRadius);  ///< degrees
  bool complex_sun = false;
  double latitude = PlaceAndTime().latitude, longitude = PlaceAndTime().longitude;
  double timezone = PlaceAndTime().timezone;
  double window_start_time = 7, window_end_time = 19;
  double start_year = 2025, start_month = 1, start_day = 1;
  double end_year = 0, end_month = 0, end_day = 0;  ///< 0: a year later
  double shutter_open = 0, shutter_close = 1;
  glm::dmat4 to_world{1.0};

  template <typename Row>
  static void parameters(const Row& row) {
    using P = TimedSkyEmitter;
    const NumberWithin factor{LowEnd::kClosed, 0.0f, kAnyNumber};
    row("turbidity", &P::turbidity, NumberWithin{LowEnd::kClosed, 1.0f, 10.0f},
        "how hazy the air is: 2 very clear, 6 hazy");
    row("albedo", &P::albedo, ColourWithin{}, "of the ground, which brightens the sky");
    row("latitude", &P::latitude, AnyNumber{"number in [-90, 90]"}, "degrees to the north");
    row("longitude", &P::longitude, AnyNumber{"number in [-180, 180]"}, "degrees to the east");
    row("timezone", &P::timezone, AnyNumber{"number"}, "hours that clocks are ahead of Greenwich");
    row("window_start_time", &P::window_start_time, AnyNumber{"number in [0, 24]"}, "first hour of each day");
    row("window_end_time", &P::window_end_time, AnyNumber{"number in [0, 24]"}, "last hour of each day");
    row("start_year", &P::start_year, AnyNumber{"number"}, "of the first day");
    row("start_month", &P::start_month, AnyNumber{"number"}, "1 to 12");
    row("start_day", &P::start_day, AnyNumber{"number"}, "1 to 31");
    row("end_year", &P::end_year, AnyNumber{"number"}, "of the day after the last; 0: a year later");
    row("end_month", &P::end_month, AnyNumber{"number"}, "1 to 12; 0: start_month");
    row("end_day", &P::end_day, AnyNumber{"number"}, "1 to 31; 0: start_day");
    row("sky_scale", &P::sky_scale, factor, "by which the sky is multiplied");
    row("sun_scale", &P::sun_scale, factor, "by which the sun is multiplied");
    row("sun_aperture", &P::sun_aperture, NumberWithin{LowEnd::kOpen, 0.0f, 179.9f},
        "diameter of the sun's disk, degrees; its power stays");
    row("complex_sun", &P::complex_sun, TrueOrFalse{}, "whether the sun's disk is darker at its limb");
    row("shutter_open", &P::shutter_open, AnyNumber{"number"}, "time of the sensor that is the first hour");
    row("shutter_close", &P::shutter_close, AnyNumber{"number"}, "time of the sensor that is the last hour");
    row("to_world", &P::to_world, AnyTransform{}, "turns it");
  }
  template <typename Given>
  void complete(Findings& findings, const Given& given) {
    if (!given("end_year") || end_year == 0) end_year = start_year + 1;
    if (!given("end_month") || end_month == 0) end_month = start_month;
    if (!given("end_day") || end_day == 0) end_day = start_day;
    check(findings);
  }

  /// The days from the first to the last, at least 1, as Mitsuba counts them.
  [[nodiscard]] double days() const;
  /// To the sun at a time of the sensor; unit, y up, as of sun_direction.
  [[nodiscard]] glm::dvec3 to_sun(double time) const;
  /// The same for `count` times of the sensor between `open` and `close`. Where these are days apart the
  /// hours of the days are spread evenly.
  [[nodiscard]] std::vector<glm::dvec3> suns(double open, double close, int count) const;
  /// The mean over the times of the sensor between `open` and `close`; black where the sun is below the
  /// horizon.
  [[nodiscard]] EnvironmentMapLight emitter(double open, double close) const;

 private:
  void check(Findings& findings) const;
  [[nodiscard]] glm::dvec3 at(double day, double hour) const;
};

using TimedSkies = std::variant<TimedSkyEmitter>;

}  // namespace penumbra
