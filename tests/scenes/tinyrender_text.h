// TinyRender scenes written in tests, and read from their own folder.
#pragma once

#include <string>
#include <string_view>

#include "tests/scenes/scene_text.h"

namespace penumbra {

class TinyRenderText : public SceneText {
 protected:
  static constexpr const char* kMaterials =
      "newmtl white\nKd .5 .6 .7\nnewmtl area_light\nKe 3 2 1\n"
      "newmtl shiny\nKd .1 .2 .3\nKs .4 .5 .6\nNs 100\n";
  /// A floor that looks up and a light that shines down.
  static constexpr const char* kModel =
      "mtllib m.mtl\no floor\nv -1 0 -1\nv -1 0 1\nv 1 0 1\nv 1 0 -1\nusemtl white\nf 1 2 3 4\n"
      "o area_light\nv 0 1 0\nv 1 1 0\nv 0 1 1\nusemtl area_light\nf 5 6 7\n";

  static std::string scene_with(std::string_view renderer,
                                std::string_view camera = "eye = [0, 1, 5]\nat = [0, 1, 0]\nfov = 40") {
    std::string text = "[input]\nobjfile = \"m.obj\"\n[camera]\n";
    text += camera;
    text += "\n[film]\nwidth = 30\nheight = 20\n[renderer]\n";
    text += renderer;
    return text + "\n";
  }

  Expected<SceneDescription> read_toml(std::string_view text, const ReadOptions& options = {}) {
    if (!std::filesystem::exists(folder_ / "m.obj")) write("m.obj", kModel);
    if (!std::filesystem::exists(folder_ / "m.mtl")) write("m.mtl", kMaterials);
    write("scene.toml", text);
    return read_scene(folder_ / "scene.toml", options);
  }

  /// Of a scene that must be good.
  SceneDescription good_toml(std::string_view text, const ReadOptions& options = {}) {
    return lit(good_of(read_toml(text, options)));
  }

  /// The error of a scene that must be bad, the folder's name left out.
  std::string toml_error(std::string_view text, const ReadOptions& options = {}) {
    return error_of(read_toml(text, options), text);
  }

  /// `model` and `materials` in the place of the usual ones.
  void use(std::string_view model, std::string_view materials = kMaterials) {
    write("m.obj", model);
    write("m.mtl", materials);
  }

  static constexpr const char* kDirect = "type = \"direct\"";
};

}  // namespace penumbra
