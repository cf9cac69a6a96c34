// <bsdf> objects as materials of the two sides of a surface.
#pragma once

#include <map>
#include <optional>
#include <set>

#include "scenes/mitsuba/plugin.h"
#include "scenes/scene_description.h"

namespace penumbra::mitsuba {

/// What each side of a surface is made of; nothing: black.
struct SurfaceMaterial {
  std::optional<Bsdf> front, back;
  bool same = false;  ///< both sides are the front's
};

class MaterialReader {
 public:
  explicit MaterialReader(const Context& context) : context_(context) {}

  /// Reads `bsdf`, once; what is wrong with it is reported, once.
  const SurfaceMaterial& read(const Object& bsdf);

  /// The indices into `scene.bsdfs` for a surface of this material, added where they are new. Without one
  /// (null) a surface is diffuse 0.5, and one that emits black, as in Mitsuba 0.5 to 3.
  std::pair<int, int> install(const Object* bsdf, bool emits, SceneDescription& scene);

 private:
  SurfaceMaterial read_new(const Object& bsdf);
  SurfaceMaterial read_two_sided(PluginReader& plugin);

  const Context& context_;
  std::map<const Object*, SurfaceMaterial> materials_;
  std::map<const Object*, std::pair<int, int>> installed_;
  std::set<const Object*> reading_;
};

}  // namespace penumbra::mitsuba
