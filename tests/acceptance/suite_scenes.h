// The scenes whose images must have the same bytes on all devices.
#pragma once

#include <iosfwd>
#include <string>
#include <vector>

#include "tests/support/render_scene.h"

namespace penumbra {

struct SuiteScene {
  std::string name;
  std::string file;  ///< below scenes/, or below the oracles
  bool is_oracle = false;
  void (*change)(SceneDescription&) = nullptr;
  bool has_ties = false;  ///< everywhere surfaces in one place, or rays through edges
};

void PrintTo(const SuiteScene& scene, std::ostream* out);

/// Every integrator, light, BSDF and way of sampling among them; oracles last.
const std::vector<SuiteScene>& suite_scenes();

/// 40 x 30 pixels, 6 samples each.
SceneDescription small_scene(const SuiteScene& scene);

/// Where and how two films first differ, for messages.
std::string first_difference(const FilmAccumulator& a, const FilmAccumulator& b);

}  // namespace penumbra
