// The parameters of Mitsuba's sky, sun and sunsky plugins, which become environment maps.
#pragma once

#include <glm/glm.hpp>
#include <span>
#include <variant>
#include <vector>

#include "scenes/emitters.h"
#include "scenes/plugin_values.h"
#include "scenes/sky/hosek_wilkie_sun.h"
#include "scenes/sky/sun_position.h"

namespace penumbra {

enum class SkyPart { kSky, kSun, kBoth };

/// From y up, x to the east and z to the south, to Mitsuba 3's frame: x to the south, y to the west, z up.
inline glm::dmat3 sky_frame_with_z_up() {
  return {glm::dvec3(0, -1, 0), glm::dvec3(0, 0, 1), glm::dvec3(1, 0, 0)};
}

struct SkyParameters {
  /// To the sun, in world space; if not given, computed from place and time in the plugin's own frame.
  glm::dvec3 sun_direction{0.0};
  float turbidity = 3.0f;
  glm::vec3 albedo{0.3f};
  float scale = 1.0f, sky_scale = 1.0f, sun_scale = 1.0f, sun_radius_scale = 1.0f, stretch = 1.0f;
  std::int64_t resolution = 2048;
  double latitude = PlaceAndTime().latitude, longitude = PlaceAndTime().longitude;
  double timezone = PlaceAndTime().timezone, year = PlaceAndTime().year, month = PlaceAndTime().month;
  double day = PlaceAndTime().day, hour = PlaceAndTime().hour, minute = PlaceAndTime().minute;
  double second = PlaceAndTime().second;
  float sun_aperture = 0.5358f;  ///< degrees
  bool complex_sun = false, extend = false;
  glm::dmat4 to_world{1.0};
  bool is_version_3 = true;

  /// The defaults are those of version 3, which has no `resolution`: the sun's disk is as wide as three
  /// texels. Version 0.6 has one kind of sun, and albedo as its code has it; its manual says 0.15.
  void written_for(int major_version) {
    is_version_3 = major_version >= 3;
    if (is_version_3) return;
    albedo = glm::vec3(0.2f);
    resolution = 512;
    complex_sun = true;
  }

  template <typename Row>
  static void parameters(const Row& row) {
    using P = SkyParameters;
    const NumberWithin factor{LowEnd::kClosed, 0.0f, kAnyNumber};
    row("turbidity", &P::turbidity, NumberWithin{LowEnd::kClosed, 1.0f, 10.0f},
        "how hazy the air is: 2 very clear, 6 hazy; beyond the model guesses");
    row("albedo", &P::albedo, ColourWithin{}, "of the ground, which brightens the sky");
    row("sun_direction", &P::sun_direction, AnyPoint{},
        "to the sun, in world space. Else by place and time, where y is up, or z in files of version 3:");
    row("latitude", &P::latitude, AnyNumber{"number in [-90, 90]"}, "degrees to the north");
    row("longitude", &P::longitude, AnyNumber{"number in [-180, 180]"}, "degrees to the east");
    row("timezone", &P::timezone, AnyNumber{"number"}, "hours that clocks are ahead of Greenwich");
    row("year", &P::year, AnyNumber{"number"}, "by those clocks");
    row("month", &P::month, AnyNumber{"number"}, "1 to 12");
    row("day", &P::day, AnyNumber{"number"}, "1 to 31");
    row("hour", &P::hour, AnyNumber{"number"}, "0 to 24");
    row("minute", &P::minute, AnyNumber{"number"}, "0 to 60");
    row("second", &P::second, AnyNumber{"number"}, "0 to 60");
    row("scale", &P::scale, factor, "by which all of it is multiplied");
    row("sky_scale", &P::sky_scale, factor, "... the sky, instead of scale");
    row("sun_scale", &P::sun_scale, factor, "... the sun, instead of scale");
    row("sun_radius_scale", &P::sun_radius_scale, NumberWithin{LowEnd::kClosed, 0.0f, 100.0f},
        "of the sun's disk, whose power stays; 0: a directional light");
    row("sun_aperture", &P::sun_aperture, NumberWithin{LowEnd::kOpen, 0.0f, 179.9f},
        "diameter of the sun's disk, degrees: another way to say its scale");
    row("complex_sun", &P::complex_sun, TrueOrFalse{},
        "whether the sun's disk is darker at its limb; else plain, as Mitsuba 3 has it");
    row("stretch", &P::stretch, NumberWithin{LowEnd::kClosed, 1.0f, 2.0f},
        "of the sky's angles from the zenith; 2 brings the horizon to the nadir");
    row("extend", &P::extend, TrueOrFalse{}, "whether the horizon goes on below it, fading to the nadir");
    row("resolution", &P::resolution, WholeNumber{8, 1 << 14}, "of the image, texels over a whole turn");
    row("to_world", &P::to_world, AnyTransform{}, "turns it");
  }
  template <typename Given>
  void complete(Findings& findings, const Given& given) {
    if (!given("sky_scale")) sky_scale = scale;
    if (!given("sun_scale")) sun_scale = scale;
    if (given("sun_aperture")) sun_radius_scale = float(sun_aperture / (2 * kSunRadius));
    // Version 0.6 does not look at the others beside a direction.
    constexpr const char* kPlaceAndTime[] = {"latitude", "longitude", "timezone", "day",   "year",
                                             "month",    "hour",      "minute",   "second"};
    for (const char* name : std::span(kPlaceAndTime).first(is_version_3 ? 9 : 4))
      if (given("sun_direction") && given(name))
        findings.push_back({name, "either sun_direction or place and time, not both"});
    check(findings, given("sun_direction"));
  }
  void check(Findings& findings, bool has_direction);

  /// This sky combined with that sun, for the emitters of both parts. Errors: they do not belong together.
  [[nodiscard]] Expected<SkyParameters> with_sun(const SkyParameters& sun) const;

  /// The emitters of a part: an environment map, whose image may be black, and for a sun without a disk,
  /// if it is up, a directional light.
  [[nodiscard]] std::vector<Emitter> emitters(SkyPart part) const;

 private:
  [[nodiscard]] glm::dmat3 frame() const;  ///< from y up to the plugin's own frame
  glm::dvec3 to_sun_{0.0, 1.0, 0.0};       ///< unit, y up
};

/// One class per plugin.
template <SkyPart kPart>
struct SkyEmitter : SkyParameters {
  static constexpr SkyPart kIs = kPart;
  static constexpr bool kIsSky = true;
  static constexpr const char* kPlugin = kPart == SkyPart::kSky   ? "sky"
                                         : kPart == SkyPart::kSun ? "sun"
                                                                  : "sunsky";
  static constexpr const char* kText = kPart == SkyPart::kSky   ? "clear sky (Hosek and Wilkie 2012)"
                                       : kPart == SkyPart::kSun ? "sun without sky"
                                                                : "clear sky and sun";
  template <typename Row>
  static void parameters(const Row& row) {
    SkyParameters::parameters(row);
  }
};
using SkyModels =
    std::variant<SkyEmitter<SkyPart::kSky>, SkyEmitter<SkyPart::kSun>, SkyEmitter<SkyPart::kBoth>>;

}  // namespace penumbra
