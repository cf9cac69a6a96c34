// Texts of Mitsuba plugins for tests.
#pragma once

#include <gmock/gmock.h>

#include <string>
#include <string_view>

#include "tests/scenes/scene_text.h"

namespace penumbra {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;
using MitsubaPlugins = SceneText;

inline std::string in(std::string_view tag, std::string_view type, std::string_view content = "") {
  return "<" + std::string(tag) + " type='" + std::string(type) + "'>" + std::string(content) + "</" +
         std::string(tag) + ">";
}
inline std::string to_world(std::string_view steps) {
  return "<transform name='to_world'>" + std::string(steps) + "</transform>";
}

}  // namespace penumbra
