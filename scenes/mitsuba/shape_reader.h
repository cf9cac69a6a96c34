// Reads <shape> objects with their materials.
#pragma once

#include <map>
#include <set>
#include <vector>

#include "scenes/file_access.h"
#include "scenes/meshes_ahead.h"
#include "scenes/mitsuba/material_reader.h"
#include "scenes/mitsuba/plugin.h"
#include "scenes/scene_description.h"

namespace penumbra::mitsuba {

class ShapeReader {
 public:
  ShapeReader(const Context& context, const FileAccess& files, MaterialReader& materials,
              SceneDescription& scene);

  /// Reads `object`, a shape of the scene itself, into the scene. Problems are reported. A mesh in which no
  /// triangle has area is left out, with a warning. A shape group becomes visible only through its instances.
  void read(const Object& object);

  /// Checks that shapes have the texture coordinates and attributes that their textures need. Call it after
  /// all textures were added to the scene.
  void check_textures() const;

 private:
  /// The container to which shapes and instances are added: the scene or a group.
  struct Holder {
    std::vector<Shape> shapes;
    std::vector<ShapeInstance> instances;
    std::vector<const Object*> objects;  ///< for each shape the object from which it was read
  };

  [[nodiscard]] std::vector<MeshRequest> meshes_named() const;
  bool begin(PluginReader& plugin, std::string_view if_cyclic);
  void read_into(const Object& object, Holder& holder);
  void read_merged(const Object& object, Holder& holder);
  void read_instance(const Object& object, Holder& holder);
  void read_shape(const Object& object, Holder& holder);
  [[nodiscard]] bool names_materials(const Object& object) const;
  /// Reads a Wavefront OBJ file as one shape per object and material.
  void read_parts(const Object& object, Holder& holder);
  /// The index of the group in the scene, or -1 after a reported error.
  int group_of(const Object& object);

  const Context& context_;
  const FileAccess& files_;
  MaterialReader& materials_;
  SceneDescription& scene_;
  MeshesAhead meshes_;
  std::map<const Object*, int> groups_;
  std::set<const Object*> reading_;
  std::vector<const Object*> objects_;                     ///< for each of the scene's shapes
  std::vector<std::vector<const Object*>> group_objects_;  ///< for each of a group's shapes
};

}  // namespace penumbra::mitsuba
