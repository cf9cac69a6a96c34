#include "scenes/pbrt/quadric_mesh.h"

#include <algorithm>
#include <cmath>

#include "scenes/angles.h"

namespace penumbra::pbrt {
namespace {

/// Columns for a full turn, and rows for half a turn along a meridian. Chords are within 1.2e-4 radii of
/// their circle.
constexpr int kTurnColumns = 200, kMeridianRows = 100;

/// A point of the profile that is rotated about the z axis, by its distance from the axis.
struct Profile {
  double r, z;
  double normal_r, normal_z;
};

/// The surface of revolution of `profile`, a function of v in [0, 1]. With z up and r to the right, the front
/// is to the left of its direction.
template <typename Curve>
Mesh turned(const Curve& profile, int rows, double degrees) {
  Mesh mesh;
  const int columns = std::max(3, int(std::ceil(kTurnColumns * degrees / kWholeTurn)));
  for (int j = 0; j <= rows; ++j) {
    const double v = double(j) / rows;
    const Profile at = profile(v);
    for (int i = 0; i <= columns; ++i) {
      const double u = double(i) / columns, phi = u * degrees * kPi / 180;
      const double x = std::cos(phi), y = std::sin(phi);
      mesh.positions.emplace_back(at.r * x, at.r * y, at.z);
      mesh.normals.emplace_back(at.normal_r * x, at.normal_r * y, at.normal_z);
      mesh.texcoords.emplace_back(u, v);
    }
  }
  const auto index = [&](int i, int j) { return std::uint32_t(j * (columns + 1) + i); };
  for (int j = 0; j < rows; ++j) {
    // At a pole one of the two triangles has no area.
    const bool starts = profile(double(j) / rows).r > 0, ends = profile(double(j + 1) / rows).r > 0;
    for (int i = 0; i < columns; ++i) {
      if (starts) mesh.triangles.emplace_back(index(i, j), index(i + 1, j), index(i + 1, j + 1));
      if (ends) mesh.triangles.emplace_back(index(i, j), index(i + 1, j + 1), index(i, j + 1));
    }
  }
  return mesh;
}

}  // namespace

Mesh sphere_mesh(double radius, double low, double high, double degrees) {
  const double from = std::acos(std::clamp(low / radius, -1.0, 1.0)),
               to = std::acos(std::clamp(high / radius, -1.0, 1.0));
  const auto profile = [&](double v) {
    const double theta = from + v * (to - from);
    // Exactly 0 at the poles.
    const bool pole = theta <= 0.0 || theta >= std::acos(-1.0);
    const double sine = pole ? 0.0 : std::sin(theta), cosine = std::cos(theta);
    return Profile{radius * sine, radius * cosine, sine, cosine};
  };
  return turned(profile, std::max(2, int(std::ceil(kMeridianRows * std::abs(to - from) / kPi))), degrees);
}

Mesh disk_mesh(double radius, double inner_radius, double height, double degrees) {
  return turned(
      [&](double v) {
        return Profile{radius + v * (inner_radius - radius), height, 0.0, 1.0};
      },
      1, degrees);
}

Mesh cylinder_mesh(double radius, double low, double high, double degrees) {
  return turned([&](double v) { return Profile{radius, low + v * (high - low), 1.0, 0.0}; }, 1, degrees);
}

}  // namespace penumbra::pbrt
