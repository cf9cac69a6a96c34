// A small scene in which something moves.
#pragma once

#include <filesystem>
#include <string>

#include "tests/scheduler/cli/small_scene.h"
#include "tests/support/temporary_folder.h"

namespace penumbra {

/// The small scene with a card above its floor that a key at 0 s and one at 1 s move.
inline void write_moving_scene(const std::filesystem::path& path) {
  write_small_scene(path);
  std::string text = file_contents(path);
  text.replace(text.find("</scene>"), 8, R"(  <shape type="rectangle">
    <animation name="to_world">
      <transform time="0"><scale value="0.4"/><rotate x="1" angle="-60"/><translate x="-1" y="0.5"/></transform>
      <transform time="1"><scale value="0.4"/><rotate x="1" angle="60"/><translate x="1" y="0.9"/></transform>
    </animation>
    <bsdf type="diffuse"><rgb name="reflectance" value="0.9, 0.1, 0.1"/></bsdf>
  </shape>
</scene>
)");
  write_text(path, text);
}

}  // namespace penumbra
