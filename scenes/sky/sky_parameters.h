// The parameters of Mitsuba's sky, sun and sunsky plugins, which become environment maps.
#pragma once

#include <glm/glm.hpp>
#include <variant>

#include "scenes/emitters.h"
#include "scenes/plugin_values.h"
#include "scenes/sky/sun_position.h"

namespace penumbra {

enum class SkyPart { kSky, kSun, kBoth };

struct SkyParameters {
  /// To the sun, in the plugin's own frame; if not given, computed from place and time.
  glm::dvec3 sun_direction{0.0};
  float turbidity = 3.0f;
  glm::vec3 albedo{0.15f};
  float scale = 1.0f, sky_scale = 1.0f, sun_scale = 1.0f, sun_radius_scale = 1.0f, stretch = 1.0f;
  std::int64_t resolution = 512;
  double latitude = PlaceAndTime().latitude, longitude = PlaceAndTime().longitude;
  double timezone = PlaceAndTime().timezone, year = PlaceAndTime().year, month = PlaceAndTime().month;
  double day = PlaceAndTime().day, hour = PlaceAndTime().hour, minute = PlaceAndTime().minute;
  double second = PlaceAndTime().second;
  float sun_aperture = 0.5358f;  ///< degrees
  glm::dmat4 to_world{1.0};
  bool is_z_up = true;

  void written_for(int major_version) {
    is_z_up = major_version >= 3;
    if (is_z_up) albedo = glm::vec3(0.3f);
  }

  template <typename Row>
  static void parameters(const Row& row) {
    using P = SkyParameters;
    const NumberWithin factor{LowEnd::kClosed, 0.0f, kAnyNumber};
    row("turbidity", &P::turbidity, NumberWithin{LowEnd::kClosed, 1.0f, 10.0f},
        "how hazy the air is: 2 very clear, 6 hazy; beyond the model guesses");
    row("albedo", &P::albedo, ColourWithin{}, "of the ground, which brightens the sky");
    row("sun_direction", &P::sun_direction, AnyPoint{},
        "to the sun; y is up, or z in files of version 3. Else by place and time:");
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
    row("sky_scale", &P::sky_scale, factor, "... the sky");
    row("sun_scale", &P::sun_scale, factor, "... the sun");
    row("sun_radius_scale", &P::sun_radius_scale, NumberWithin{LowEnd::kClosed, 0.0f, 100.0f},
        "of the sun's disk, whose power stays; 0: a directional light, where no sky is beside it");
    row("sun_aperture", &P::sun_aperture, NumberWithin{LowEnd::kOpen, 0.0f, 90.0f},
        "diameter of the sun's disk, degrees: another way to say its scale");
    row("stretch", &P::stretch, NumberWithin{LowEnd::kClosed, 1.0f, 2.0f},
        "of the sky's angles from the zenith; 2 brings the horizon to the nadir");
    row("resolution", &P::resolution, WholeNumber{8, 1 << 14}, "of the image, texels over a whole turn");
    row("to_world", &P::to_world, AnyTransform{}, "turns it");
  }
  template <typename Given>
  void complete(Findings& findings, const Given& given) {
    check(findings, given("sun_direction"));
    if (given("sun_aperture")) sun_radius_scale = sun_aperture / 0.5358f;
  }
  void check(Findings& findings, bool has_direction);

  /// This sky combined with that sun, for `emitter` of both parts. Errors: they do not belong together.
  [[nodiscard]] Expected<SkyParameters> with_sun(const SkyParameters& sun) const;

  /// The emitter of a part: an environment map, whose image may be black, or a directional light for a sun
  /// without a disk.
  [[nodiscard]] Emitter emitter(SkyPart part) const;

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
  static constexpr const char* kText = kPart == SkyPart::kSky   ? "clear sky (Preetham et al. 1999)"
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
