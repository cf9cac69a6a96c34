// The scene as a kernel sees it: the header and typed pointers into the flat array.
#ifndef PENUMBRA_SCENE_H
#define PENUMBRA_SCENE_H
#include "kernels/block/path_state.h"
#include "kernels/scene_types.h"

PENUMBRA_NAMESPACE_BEGIN

#ifdef EXTERNAL_TRACER
/// An external intersector, for native code: finds `hit` of `count` lanes for their rays, or
/// `shadow_transmittance` for their shadow rays.
typedef struct {
  const void* context;
  void (*intersect)(const void* context, const PathState* paths, int count);
  void (*occlude)(const void* context, const PathState* paths, int count);
} Tracer;
#endif

typedef struct {
  SceneHeader header;
#ifdef EXTERNAL_TRACER
  Tracer tracer;  ///< null functions: the portable intersector
#endif
#define TABLE_POINTER(_, name, record, least, what) GLOBAL const record* name;
  SCENE_TABLES(TABLE_POINTER, _)
#undef TABLE_POINTER
} Scene;

FN Scene make_scene(SceneHeader header, GLOBAL const uint* words) {
  Scene s;
  s.header = header;
#define POINT_TO_TABLE(s, name, record, least, what) \
  s.name = (GLOBAL const record*)(words + header.tables.name.offset);
  SCENE_TABLES(POINT_TO_TABLE, s)
#undef POINT_TO_TABLE
  return s;
}

// Whether its glossy surfaces are linearly transformed cosines to lights: then their table is there.
#define NEEDS_LTC(scene) (NEEDS(scene, LTC) && (scene)->header.tables.ltc_cells.count > 0)
// Whether its lights are chosen by their hierarchy: then that is there.
#define NEEDS_LIGHT_TREE(scene) \
  (NEEDS(scene, LIGHT_TREE) && (scene)->header.integrator.light_choice == CHOICE_TREE)
// Whether it has media: then their tables are there.
#define NEEDS_MEDIA(scene) (NEEDS(scene, MEDIA) && (scene)->header.tables.media.count > 0)
// Whether its camera sees edges of lights that are in its tables.
#define NEEDS_LIGHT_EDGES(scene) (NEEDS(scene, LIGHT_EDGES) && (scene)->header.sees_edges != 0)

PENUMBRA_NAMESPACE_END
#endif
