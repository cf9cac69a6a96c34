// The position of the sun.
#pragma once

#include <glm/glm.hpp>

namespace penumbra {

struct PlaceAndTime {
  double latitude = 35.6894;    ///< degrees, positive to the north
  double longitude = 139.6917;  ///< degrees, positive to the east
  double timezone = 9;          ///< hours ahead of Greenwich
  double year = 2010, month = 7, day = 10, hour = 15, minute = 0, second = 0;  ///< local time
};

/// The day's number in the Gregorian calendar. Only its whole part counts. A day may be after the last of its
/// month.
double day_number(double year, double month, double day);

/// The unit direction to the sun: x to the east, y up, z to the south. The error is 0.01 degrees for the
/// years 1999 to 2015, and about 0.1 degrees for the years around. Algorithm of Plataforma Solar de Almeria
/// (Blanco-Muriel et al. 2001, Computing the solar vector).
glm::dvec3 sun_direction(const PlaceAndTime& at);

}  // namespace penumbra
