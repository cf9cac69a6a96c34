// The sun of Hosek and Wilkie 2013, Adding a solar-radiance function to the Hosek-Wilkie skylight model.
#pragma once

#include <algorithm>
#include <glm/glm.hpp>
#include <glm/gtc/constants.hpp>
#include <vector>

namespace penumbra {

constexpr double kSunRadius = 0.5358 / 2;  ///< degrees, as seen from the earth

/// The sun's disk seen through the atmosphere. Colours are those of HosekWilkieSky. The authors' coefficients
/// are in hosek_wilkie/.
class HosekWilkieSun {
 public:
  /// `turbidity` is in [1, 10].
  explicit HosekWilkieSun(double turbidity);

  /// The radiance at a point of the disk, seen `elevation` radians above the horizon; black below it.
  /// `cosine` is that of the angle between the sun's radius there and the direction to the viewer: 1 in the
  /// middle, 0 at the limb. The colour of a low sun is outside the gamut, and so its blue below 0.
  [[nodiscard]] glm::dvec3 radiance(double elevation, double cosine) const;

  /// The mean of the radiance over that part of the disk which is above the horizon. `elevation` is the
  /// disk's middle's, in radians.
  [[nodiscard]] glm::dvec3 mean_radiance(double elevation) const;

  /// The share of the disk that is above the horizon, in [0, 1]. `elevation` is the middle's, in radians. The
  /// disk is so small that it is a circle in a plane.
  [[nodiscard]] static double visible_share(double elevation);

  /// The radiance of the plain disk that Mitsuba 3 draws unless `complex_sun` asks for the model: the mean
  /// radiance at 30 elevations from 2° to 89°, linear between them and constant beyond. Where the radiance
  /// rises steeply, below 10°, this is more than the model's.
  [[nodiscard]] glm::dvec3 plain_radiance(double elevation) const;
  static constexpr int kPlainNodes = 30;
  /// The mean radiance at one of those elevations.
  [[nodiscard]] glm::dvec3 plain_node(int node) const;
  /// The plain radiance from that at the elevations, given as a function of their number.
  template <typename Node>
  [[nodiscard]] static glm::dvec3 plain_between(double elevation, const Node& radiance_at) {
    const double at = std::clamp((elevation - kFirstNode) / kNodeStep, 0.0, kPlainNodes - 1.0);
    const int node = std::min(int(at), kPlainNodes - 2);
    return glm::mix(radiance_at(node), radiance_at(node + 1), at - node);
  }

 private:
  static constexpr double kFirstNode = 2 * (glm::pi<double>() / 180),
                          kNodeStep = 3 * (glm::pi<double>() / 180);
  static constexpr int kPowers = 4, kLimbPowers = 6;
  /// For a segment of elevations: of the elevation's power, times the limb's.
  struct Segment {
    glm::dvec3 coefficients[kPowers][kLimbPowers];
  };
  std::vector<Segment> segments_;
};

/// A unit vector of the disk of angular radius `radius` (radians) about z: the k-th of `count`, which are
/// evenly distributed on a spiral.
glm::dvec3 disk_direction(int k, int count, double radius);

/// The solid angle of a disk of angular radius `radius` (radians).
double disk_solid_angle(double radius);

/// The cosine between the sun's radius and the direction to the viewer, where `sine` is that of the angle
/// from the middle of a disk of angular radius `radius` (radians).
double limb_cosine(double sine, double radius);

}  // namespace penumbra
