#pragma once
#include <numbers>

namespace penumbra {

inline constexpr double kPi = std::numbers::pi;
inline constexpr double kDegree = kPi / 180;  ///< in radians

}  // namespace penumbra
