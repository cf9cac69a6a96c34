// <shape> objects, with their materials.
#pragma once

#include <map>
#include <set>
#include <vector>

#include "scenes/file_access.h"
#include "scenes/mitsuba/material_reader.h"
#include "scenes/mitsuba/plugin.h"
#include "scenes/scene_description.h"

namespace penumbra::mitsuba {

class ShapeReader {
 public:
  ShapeReader(const Context& context, const FileAccess& files, MaterialReader& materials,
              SceneDescription& scene)
      : context_(context), files_(files), materials_(materials), scene_(scene) {}

  /// Reads `object`, one of the scene's own, into the scene; what is wrong is reported. A mesh without a
  /// triangle that has area is left out, with a warning. A group of shapes is in the scene where its
  /// instances are.
  void read(const Object& object);

  /// That shapes have what their textures show. Once all textures are the scene's.
  void check_textures() const;

 private:
  /// What shapes and instances are added to: the scene, or a group.
  struct Holder {
    std::vector<Shape> shapes;
    std::vector<ShapeInstance> instances;
    std::vector<const Object*> objects;  ///< what the shapes were read from
  };

  bool begin(PluginReader& plugin, std::string_view if_cyclic);
  void read_into(const Object& object, Holder& holder);
  void read_merged(const Object& object, Holder& holder);
  void read_instance(const Object& object, Holder& holder);
  void read_shape(const Object& object, Holder& holder);
  [[nodiscard]] bool names_materials(const Object& object) const;
  /// A Wavefront file as a shape for each object and material.
  void read_parts(const Object& object, Holder& holder);
  /// Its index in the scene, or -1 where something is wrong, which was reported.
  int group_of(const Object& object);

  const Context& context_;
  const FileAccess& files_;
  MaterialReader& materials_;
  SceneDescription& scene_;
  std::map<const Object*, int> groups_;
  std::set<const Object*> reading_;
  std::vector<const Object*> objects_;                     ///< of the scene's shapes
  std::vector<std::vector<const Object*>> group_objects_;  ///< of each group's
};

}  // namespace penumbra::mitsuba
