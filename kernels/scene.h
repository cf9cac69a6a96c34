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
  GLOBAL const Triangle* triangles;
  GLOBAL const VertexNormals* normals;
  GLOBAL const Quadric* quadrics;
  GLOBAL const Material* materials;
  GLOBAL const Light* lights;
  GLOBAL const Polygon* polygons;
  GLOBAL const PolygonCorner* polygon_corners;
  GLOBAL const vec3* vertices;
  GLOBAL const Corner* corners;
  GLOBAL const BvhNode* nodes;
  GLOBAL const TriangleLeaf* triangle_leaves;
  GLOBAL const QuadricLeaf* quadric_leaves;
  GLOBAL const float* filter_table;
} Scene;

FN Scene make_scene(SceneHeader header, GLOBAL const uint* words) {
  Scene s;
  s.header = header;
  s.triangles = (GLOBAL const Triangle*)(words + header.triangles);
  s.normals = (GLOBAL const VertexNormals*)(words + header.normals);
  s.quadrics = (GLOBAL const Quadric*)(words + header.quadrics);
  s.materials = (GLOBAL const Material*)(words + header.materials);
  s.lights = (GLOBAL const Light*)(words + header.lights);
  s.polygons = (GLOBAL const Polygon*)(words + header.polygons);
  s.polygon_corners = (GLOBAL const PolygonCorner*)(words + header.polygon_corners);
  s.vertices = (GLOBAL const vec3*)(words + header.vertices);
  s.corners = (GLOBAL const Corner*)(words + header.corners);
  s.nodes = (GLOBAL const BvhNode*)(words + header.nodes);
  s.triangle_leaves = (GLOBAL const TriangleLeaf*)(words + header.triangle_leaves);
  s.quadric_leaves = (GLOBAL const QuadricLeaf*)(words + header.quadric_leaves);
  s.filter_table = (GLOBAL const float*)(words + header.filter_table);
  return s;
}

PENUMBRA_NAMESPACE_END
#endif
