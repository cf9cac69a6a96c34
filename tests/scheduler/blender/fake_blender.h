// A program that behaves as Blender with the script that exports does, but whose scenes are made up.
#pragma once

#include <fmt/format.h>

#include <filesystem>
#include <string>
#include <string_view>

#include "tests/scheduler/cli/small_scene.h"
#include "tests/support/temporary_folder.h"

namespace penumbra {

/// In the small scene with 25 frames a second, a card moves by the number of the frame, 7 without any. The
/// camera's name and the folder's file `runs`, with a process number a line, tell what it was asked for.
/// `before`: shell commands before each $frame is written.
inline std::filesystem::path write_fake_blender(const std::filesystem::path& folder,
                                                std::string_view before = "",
                                                std::string_view version = "Blender 4.2.0 LTS") {
  write_small_scene(folder / "template");
  std::string scene = file_contents(folder / "template");
  scene.replace(scene.find("</scene>"), 8, R"(<shape type="rectangle">
  <transform name="to_world"><scale value="0.3"/><translate x="0.1"/><scale x="FRAME"/><translate y="1"/></transform>
</shape></scene>)");
  write_text(folder / "template", scene);
  write_text(folder / "shot.blend", "BLENDER");
  const std::filesystem::path program = folder / "blender";
  write_text(program, fmt::format(R"(#!/bin/sh
here='{0}'
if [ "$1" = --version ]; then echo "a library's remark"; echo "{1}"; exit; fi
echo $$ >> "$here/runs"
echo "Color management: noise"
for word; do
  case $word in
    --out=*) out=${{word#*=}} ;;
    --result=*) result=${{word#*=}} ;;
    --frames=*) frames=${{word#*=}} ;;
    --camera=*) echo "{{\"error\": \"no camera '${{word#*=}}'\"}}" > "$result"; exit 2 ;;
  esac
done
for frame in $(echo ${{frames:-7}} | tr , '\n' | while IFS=- read -r first last; do seq $first ${{last:-$first}}; done); do
  {2}
  sed "s/FRAME/$frame/" "$here/template" > "$out/frame.$frame.xml"
  printf '{{"frame": %d, "path": "%s", "fps": 25.0, "report": ["object \\"Lamp\\": is left out"]}}\n' \
    $frame "$out/frame.$frame.xml" >> "$result"
done
)",
                                  folder.string(), version, before));
  std::filesystem::permissions(program, std::filesystem::perms::owner_all);
  return program;
}

/// The same of a scene that only holds $frame.
inline std::string scene_of_fake_blender(const std::filesystem::path& folder, int frame) {
  std::string scene = file_contents(folder / "template");
  const std::size_t at = scene.find("FRAME");
  return scene.replace(at, 5, fmt::to_string(frame));
}

}  // namespace penumbra
