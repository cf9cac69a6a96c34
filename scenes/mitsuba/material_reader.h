// <bsdf> objects as materials of the two sides of a surface.
#pragma once

#include <map>
#include <memory>
#include <set>
#include <utility>
#include <vector>

#include "scenes/material_tree.h"
#include "scenes/mitsuba/plugin.h"
#include "scenes/scene_description.h"

namespace penumbra::mitsuba {

class MaterialReader {
 public:
  explicit MaterialReader(const Context& context) : context_(context) {}

  /// Reads `bsdf`, once; what is wrong with it is reported, once.
  const SurfaceMaterial& read(const Object& bsdf);

  /// The indices into `scene.bsdfs` for a shape of this material, added where they are new. Without one
  /// (null) a surface is diffuse 0.5, and one that emits black, as in Mitsuba 0.5 to 3; in 0.x one that only
  /// parts media is none.
  std::pair<int, int> install(const Object* bsdf, const Shape& shape, SceneDescription& scene);

  /// The id of the BSDF, or of the first with one of those that it holds, each the first of its holder; empty
  /// if there is none.
  [[nodiscard]] std::string id_of(const Object* bsdf) const;

 private:
  SurfaceMaterial read_new(const Object& bsdf);
  SurfaceMaterial read_two_sided(PluginReader& plugin);
  SurfaceMaterial read_null(PluginReader& plugin);
  SurfaceMaterial read_mask(PluginReader& plugin);
  SurfaceMaterial read_blend(PluginReader& plugin);
  SurfaceMaterial read_mixture(PluginReader& plugin);
  SurfaceMaterial read_polarizer(PluginReader& plugin);
  SurfaceMaterial read_coating(PluginReader& plugin);
  SurfaceMaterial read_normal_map(PluginReader& plugin);
  SurfaceMaterial read_bump_map(PluginReader& plugin);
  template <typename Parameters>
  SurfaceMaterial read_bent(PluginReader& plugin, Parameters parameters, SurfaceBend bend);
  std::vector<const SurfaceMaterial*> read_nested(PluginReader& plugin, std::size_t count);

  struct Holder;
  static const std::vector<Holder>& holders();

  const Context& context_;
  std::map<const Object*, SurfaceMaterial> materials_;
  MaterialInstaller installer_;
  std::set<const Object*> reading_;
};

}  // namespace penumbra::mitsuba
