// Reads <bsdf> objects as materials of the two sides of a surface.
#pragma once

#include <map>
#include <memory>
#include <set>
#include <utility>
#include <vector>

#include "scenes/material_tree.h"
#include "scenes/measured_file.h"
#include "scenes/mitsuba/plugin.h"
#include "scenes/scene_description.h"

namespace penumbra::mitsuba {

class MaterialReader {
 public:
  explicit MaterialReader(const Context& context) : context_(context) {}

  /// Reads `bsdf` on the first call; later calls return the same. Problems are reported once.
  const SurfaceMaterial& read(const Object& bsdf);

  /// The indices in `scene.bsdfs` of the two sides for a shape with this BSDF, which is added if it is new.
  /// Without a BSDF (null) a surface is diffuse with reflectance 0.5, and an emitting one is black, as in
  /// Mitsuba 0.5 to 3. In 0.x a shape without a BSDF that only bounds a medium is invisible.
  std::pair<int, int> install(const Object* bsdf, const Shape& shape, SceneDescription& scene,
                              bool is_tube = false);

  /// The id of the BSDF; if it has none, that of its first nested BSDF, and so on. Empty if none of them has
  /// an id.
  [[nodiscard]] std::string id_of(const Object* bsdf) const;

 private:
  SurfaceMaterial read_new(const Object& bsdf);
  SurfaceMaterial read_two_sided(PluginReader& plugin);
  SurfaceMaterial read_null(PluginReader& plugin);
  SurfaceMaterial read_mask(PluginReader& plugin);
  SurfaceMaterial read_blend(PluginReader& plugin);
  SurfaceMaterial read_mixture(PluginReader& plugin);
  SurfaceMaterial read_metal_rough(PluginReader& plugin);
  SurfaceMaterial read_standard_surface(PluginReader& plugin);
  SurfaceMaterial read_measured(PluginReader& plugin);
  SurfaceMaterial read_polarizer(PluginReader& plugin);
  SurfaceMaterial read_coating(PluginReader& plugin);
  template <typename Parameters>
  SurfaceMaterial read_lajolla(PluginReader& plugin);
  SurfaceMaterial read_normal_map(PluginReader& plugin);
  SurfaceMaterial read_bump_map(PluginReader& plugin);
  SurfaceMaterial read_turned(PluginReader& plugin);
  template <typename Parameters>
  SurfaceMaterial read_bent(PluginReader& plugin, Parameters parameters, SurfaceBend bend);
  std::vector<const SurfaceMaterial*> read_nested(PluginReader& plugin, std::size_t count);

  struct Holder;
  static const std::vector<Holder>& holders();

  const Context& context_;
  std::map<const Object*, SurfaceMaterial> materials_;
  std::map<const Object*, SurfaceMaterial> of_tubes_, of_curves_;
  MaterialInstaller installer_;
  MeasuredFiles measured_;
  std::set<const Object*> reading_;
};

}  // namespace penumbra::mitsuba
