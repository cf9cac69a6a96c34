// Nori's <test> files, which contain scenes or BSDFs and their expected values.
#pragma once

#include <optional>
#include <pugixml.hpp>
#include <vector>

#include "scenes/mitsuba/value_reader.h"
#include "scenes/nori/object_edit.h"

namespace penumbra::nori {

/// One scene of a test. For a BSDF the scene is built here: a plane with that BSDF under radiance 1 from all
/// directions, seen from one of the test's angles. The reflected radiance is then the albedo at that angle.
struct TestScene {
  pugi::xml_node element;                      ///< <scene> or <bsdf>
  std::optional<double> angle = std::nullopt;  ///< for a BSDF: the view angle, degrees from the normal
  std::optional<double> reference = std::nullopt;
  std::int64_t samples = 100'000;     ///< the number of samples of the test
  std::size_t number = 1, count = 1;  ///< position among the test's scenes, and their number
};

/// The scene of that number, or the first. Nothing, and an error, if there is none.
std::optional<TestScene> choose_test_scene(const mitsuba::ElementReader& test, std::optional<int> number,
                                           ReaderReport& report);

/// Configures the camera of a test scene: the test's number of samples is spread evenly over the film.
void settle_test_camera(const Translation& t, mitsuba::Object& scene, std::int64_t samples);

/// Adds the plane with the BSDF, the light and the camera to the scene.
void build_bsdf_scene(const Translation& t, mitsuba::Object& scene, mitsuba::Object& bsdf, double angle);

}  // namespace penumbra::nori
