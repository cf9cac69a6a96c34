#include "scenes/sky/sun_position.h"

#include <cmath>

#include "scenes/angles.h"

namespace penumbra {

/// Fliegel and Van Flandern 1968, whose divisions are of whole numbers.
double day_number(double any_year, double any_month, double any_day) {
  const auto year = std::trunc(any_year), month = std::trunc(any_month), day = std::trunc(any_day);
  const double a = std::trunc((month - 14) / 12);
  return std::trunc(1461 * (year + 4800 + a) / 4) + std::trunc(367 * (month - 2 - 12 * a) / 12) -
         std::trunc(3 * std::trunc((year + 4900 + a) / 100) / 4) + day - 32075;
}

glm::dvec3 sun_direction(const PlaceAndTime& at) {
  const double hours = at.hour - at.timezone + (at.minute + at.second / 60) / 60;  // Greenwich time
  // Days from noon of 1 January 2000.
  const double n = day_number(at.year, at.month, at.day) - 0.5 + hours / 24 - 2451545.0;
  // Ecliptic coordinates, radians.
  const double omega = 2.1429 - 0.0010394594 * n;
  const double mean_longitude = 4.8950630 + 0.017202791698 * n, anomaly = 6.2400600 + 0.0172019699 * n;
  const double longitude = mean_longitude + 0.03341607 * std::sin(anomaly) +
                           0.00034894 * std::sin(2 * anomaly) - 0.0001134 - 0.0000203 * std::sin(omega);
  const double obliquity = 0.4090928 - 6.2140e-9 * n + 0.0000396 * std::cos(omega);
  // Celestial coordinates.
  const double ascension = std::atan2(std::cos(obliquity) * std::sin(longitude), std::cos(longitude));
  const double declination = std::asin(std::sin(obliquity) * std::sin(longitude));
  // Local coordinates.
  const double sidereal = 6.6974243242 + 0.0657098283 * n + hours;
  const double hour_angle = (sidereal * 15 + at.longitude) * kDegree - ascension, phi = at.latitude * kDegree;
  double zenith = std::acos(std::cos(phi) * std::cos(hour_angle) * std::cos(declination) +
                            std::sin(declination) * std::sin(phi));
  const double azimuth = std::atan2(
      -std::sin(hour_angle), std::tan(declination) * std::cos(phi) - std::sin(phi) * std::cos(hour_angle));
  // Parallax: seen from the earth's surface, not its centre.
  zenith += 6371.01 / 149597890.0 * std::sin(zenith);
  return {std::sin(azimuth) * std::sin(zenith), std::cos(zenith), -std::cos(azimuth) * std::sin(zenith)};
}

}  // namespace penumbra
