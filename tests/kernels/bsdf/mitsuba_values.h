// Values of BSDFs that Mitsuba 3 has computed: the tables of this folder.
#pragma once

#include <gtest/gtest.h>

#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "scenes/scene_reader.h"
#include "tests/kernels/kernels_under_test.h"
#include "tests/support/temporary_folder.h"

namespace penumbra {

/// A BSDF, and its values.
struct MitsubaValue {
  vec3 wo, wi, f_cos;
  float pdf;
};
struct MitsubaBsdf {
  std::string xml;
  std::vector<MitsubaValue> values;
};

/// Of a file of this folder.
inline std::vector<MitsubaBsdf> mitsuba_bsdfs(const std::string& name) {
  std::vector<MitsubaBsdf> result;
  std::ifstream file(std::string(PENUMBRA_SOURCE_DIR "/tests/kernels/bsdf/") + name);
  for (std::string line; std::getline(file, line);) {
    if (line.starts_with('<')) {
      result.push_back({line, {}});
      continue;
    }
    std::istringstream numbers(line);
    MitsubaValue v{};
    for (vec3* each : {&v.wo, &v.wi, &v.f_cos}) numbers >> each->x >> each->y >> each->z;
    numbers >> v.pdf;
    EXPECT_TRUE(numbers) << line;
    result.back().values.push_back(v);
  }
  return result;
}

inline BsdfModel model_of(const std::string& xml) {
  TemporaryFolder folder;
  write_text(
      folder / "scene.xml",
      "<scene version='3.0.0'><sensor type='perspective'/><shape type='sphere'>" + xml + "</shape></scene>");
  const auto scene = read_scene(folder / "scene.xml", {});
  EXPECT_TRUE(scene) << scene.error().message;
  return scene->bsdfs.at(0).model;
}

}  // namespace penumbra
