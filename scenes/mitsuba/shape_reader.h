// Reads <shape> objects with their materials.
#pragma once

#include <map>
#include <memory>
#include <set>
#include <vector>

#include "scenes/file_access.h"
#include "scenes/meshes_ahead.h"
#include "scenes/mitsuba/animation.h"
#include "scenes/mitsuba/material_reader.h"
#include "scenes/mitsuba/plugin.h"
#include "scenes/scene_description.h"

namespace penumbra::mitsuba {

class ShapeReader {
 public:
  ShapeReader(const Context& context, const FileAccess& files, MaterialReader& materials,
              Animations& animations, SceneDescription& scene);

  /// Reads `object`, a shape of the scene itself, into the scene. Problems are reported. A mesh in which no
  /// triangle has area is left out, with a warning. A shape group becomes visible only through its instances.
  void read(const Object& object);

  /// Checks that shapes have the texture coordinates and attributes that their textures need. Call it after
  /// all textures were added to the scene.
  void check_textures() const;

  /// Adds the shapes and instances that move to the animations. Call it when all shapes were read.
  void add_motion();

 private:
  /// The object from which a shape or an instance was read.
  struct Source {
    const Object* object = nullptr;
    bool computed_normals = false;                        ///< those of a mesh are not its file's
    std::shared_ptr<const DeformingMesh> deforming = {};  ///< of a mesh of several files over time
  };
  /// The container to which shapes and instances are added: the scene or a group.
  struct Holder {
    std::vector<Shape> shapes;
    std::vector<ShapeInstance> instances;
    std::vector<Source> sources = {};                  ///< for each shape
    std::vector<const Object*> instance_objects = {};  ///< for each instance
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
  Animations& animations_;
  SceneDescription& scene_;
  MeshesAhead meshes_;
  std::map<const Object*, int> groups_;
  std::set<const Object*> reading_;
  std::vector<Source> sources_;                     ///< for each of the scene's shapes
  std::vector<const Object*> instance_objects_;     ///< for each of its instances
  std::vector<std::vector<Source>> group_sources_;  ///< for each of a group's shapes
};

}  // namespace penumbra::mitsuba
