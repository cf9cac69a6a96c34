// The scene as kernels see it: the header, and typed pointers to the tables in one flat array of words.
#ifndef PENUMBRA_SCENE_H
#define PENUMBRA_SCENE_H
#include "kernels/block/path_state.h"
#include "kernels/scene_types.h"

PENUMBRA_NAMESPACE_BEGIN

#ifdef EXTERNAL_TRACER
/// An external intersector (Embree), for native code only. `intersect` sets `hit` of the first `count` lanes;
/// `occlude` sets `shadow_transmittance` of their shadow rays.
typedef struct {
  const void* context;
  void (*intersect)(const void* context, const PathState* paths, int count);
  void (*occlude)(const void* context, const PathState* paths, int count);
} Tracer;
#endif

typedef struct {
  SceneHeader header;
#ifdef EXTERNAL_TRACER
  Tracer tracer;  ///< with null functions, kernels use the portable intersector
#endif
  GLOBAL const uint* photons;  ///< the photon maps, see NEEDS_PHOTONS and photon/photon_map.h
#define TABLE_POINTER(_, name, record, least, what) GLOBAL const record* name;
  SCENE_TABLES(TABLE_POINTER, _)
#undef TABLE_POINTER
} Scene;

FN Scene make_scene(SceneHeader header, GLOBAL const uint* words) {
  Scene s;
  s.header = header;
  s.photons = 0;
#define POINT_TO_TABLE(s, name, record, least, what) \
  s.name = (GLOBAL const record*)(words + header.tables.name.offset);
  SCENE_TABLES(POINT_TO_TABLE, s)
#undef POINT_TO_TABLE
  return s;
}

// load_<record>(pointer): the record, read member by member. Lane loops that copy whole records do not
// vectorise.
#define MEMBER_vec3(record, member) load3(&(record)->member)
#define MEMBER_float(record, member) (record)->member
#define MEMBER_int(record, member) (record)->member
#define LOAD_MEMBER(type, member) loaded.member = MEMBER_##type(record, member);
#define LOADED_RECORD(Name, name, FIELDS)          \
  FN Name load_##name(GLOBAL const Name* record) { \
    Name loaded;                                   \
    FIELDS(LOAD_MEMBER)                            \
    return loaded;                                 \
  }
LOADED_RECORD(Instance, instance, INSTANCE_FIELDS)
LOADED_RECORD(Quadric, quadric, QUADRIC_FIELDS)
LOADED_RECORD(Light, light, LIGHT_FIELDS)
LOADED_RECORD(Beam, beam, BEAM_FIELDS)
LOADED_RECORD(Motion, motion, MOTION_FIELDS)
#undef LOADED_RECORD
#undef LOAD_MEMBER

// Whether glossy BSDFs use linearly transformed cosines under polygon lights. If so, the scene has their
// table.
#define NEEDS_LTC(scene) (NEEDS(scene, LTC) && (scene)->header.tables.ltc_cells.count > 0)
// Whether lights are chosen through the light hierarchy. If so, the scene has its tables.
#define NEEDS_LIGHT_TREE(scene) \
  (NEEDS(scene, LIGHT_TREE) && (scene)->header.integrator.light_choice == CHOICE_TREE)
// Whether direct and indirect light are told apart.
#define NEEDS_SPLIT_LIGHT(scene) (NEEDS(scene, DIRECT_LAYER) || NEEDS(scene, INDIRECT_LAYER))
// Whether the scene has participating media. If so, it has their tables.
#define NEEDS_MEDIA(scene) (NEEDS(scene, MEDIA) && (scene)->header.tables.media.count > 0)
// Whether a medium emits.
#define NEEDS_EMITTING_MEDIA(scene) (NEEDS(scene, EMITTING_MEDIA) && NEEDS_MEDIA(scene))
// Whether materials have media inside.
#define NEEDS_INTERIORS(scene) \
  (NEEDS(scene, INTERIORS) && NEEDS_MEDIA(scene) && (scene)->header.tables.boundaries.count > 0)
// Whether something moves while the shutter is open. If so, the scene has its tables.
#define NEEDS_MOTION(scene) (NEEDS(scene, MOTION) && (scene)->header.tables.shutter.count > 0)
// Whether shadow rays may pass what they hit.
#define NEEDS_PASSING_LIGHT(scene) (NEEDS(scene, NESTED) || NEEDS(scene, FLAT_GLASS))
// Whether what shadow rays pass tints their light, and whether that or media colour it.
#define NEEDS_TINTS(scene) (NEEDS(scene, PANES) || NEEDS(scene, FLAT_GLASS))
#define NEEDS_PASSES(scene) (NEEDS_MEDIA(scene) || NEEDS_TINTS(scene))
// Whether the scene has photon maps. If so, `photons` are they.
#define NEEDS_PHOTONS(scene) (NEEDS(scene, PHOTONS) && (scene)->header.integrator.photons != PHOTONS_NONE)
// Whether the paths are those of photons: there are no maps yet.
#define TRACES_PHOTONS(scene) (NEEDS_PHOTONS(scene) && (scene)->photons == 0)
// Whether the camera is panoramic. OpenCL kernels may be compiled for more features than the scene has.
#define NEEDS_PANORAMA(scene) (NEEDS(scene, PANORAMA) && (scene)->header.camera.panorama != 0.0f)
// Whether the scene has a table of light edges and the current camera is the one that it was made for.
#define NEEDS_LIGHT_EDGES(scene) (NEEDS(scene, LIGHT_EDGES) && (scene)->header.sees_edges != 0)

PENUMBRA_NAMESPACE_END
#endif
