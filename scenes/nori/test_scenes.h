// <test>: files of Nori's that hold scenes, or BSDFs, and what they should come to.
#pragma once

#include <optional>
#include <pugixml.hpp>
#include <vector>

#include "scenes/mitsuba/value_reader.h"
#include "scenes/nori/object_edit.h"

namespace penumbra::nori {

/// One of the scenes of a test. Those of a BSDF are made here: a plane of it in light of radiance 1 from all
/// directions, seen from one of the test's angles, so that what comes back is its albedo there.
struct TestScene {
  pugi::xml_node element;                      ///< <scene> or <bsdf>
  std::optional<double> angle = std::nullopt;  ///< of a BSDF: degrees from the normal
  std::optional<double> reference = std::nullopt;
  std::int64_t samples = 100'000;     ///< of the test
  std::size_t number = 1, count = 1;  ///< among the scenes of the test
};

/// The scene of that number, or the first; nothing, and an error, where there is none.
std::optional<TestScene> choose_test_scene(const mitsuba::ElementReader& test, std::optional<int> number,
                                           ReaderReport& report);

/// The camera of a scene of a test: its samples are spread evenly over the film, as many as the test says.
void settle_test_camera(const Translation& t, mitsuba::Object& scene, std::int64_t samples);

/// Puts the plane with the BSDF, the light, and the camera into the scene.
void build_bsdf_scene(const Translation& t, mitsuba::Object& scene, mitsuba::Object& bsdf, double angle);

}  // namespace penumbra::nori
