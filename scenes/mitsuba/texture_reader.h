// <texture> objects as textures of a scene.
#pragma once

#include <map>
#include <optional>
#include <set>
#include <vector>

#include "scenes/mitsuba/plugin.h"
#include "scenes/textures.h"

namespace penumbra::mitsuba {

class TextureReader {
 public:
  explicit TextureReader(const Context& context) : context_(context) {}

  /// Its index among the textures, which it is added to where it is new. What is wrong with it is reported,
  /// once; then there is none.
  std::optional<int> read(const Object& object);

  [[nodiscard]] std::vector<SceneTexture> take() { return std::move(textures_); }

 private:
  std::optional<SceneTexture> read_new(const Object& object);

  const Context& context_;
  std::map<const Object*, std::optional<int>> known_;
  std::set<const Object*> reading_;
  std::vector<SceneTexture> textures_;
};

}  // namespace penumbra::mitsuba
