// Reading inputs and writing outputs of quantities as doubles, and a dummy scene.
#ifndef PENUMBRA_STRESS_QUANTITY_NUMBERS_H
#define PENUMBRA_STRESS_QUANTITY_NUMBERS_H
#include "kernels/light/light.h"
#include "scheduler/stress/quantity_list.h"

PENUMBRA_NAMESPACE_BEGIN

FN float in_f(GLOBAL const double* in, int i) { return (float)in[i]; }
FN uint in_u(GLOBAL const double* in, int i) { return (uint)in[i]; }
FN vec3 in_v(GLOBAL const double* in, int i) {
  return make_vec3((float)in[i], (float)in[i + 1], (float)in[i + 2]);
}
FN void out_v(GLOBAL double* out, int i, vec3 v) {
  out[i] = v.x;
  out[i + 1] = v.y;
  out[i + 2] = v.z;
}
FN void set_v(GLOBAL vec3* to, vec3 v) {
  to->x = v.x;
  to->y = v.y;
  to->z = v.z;
}

/// A dummy scene in scratch memory with one empty record in each table, for functions that take a scene.
FN Scene scratch_scene(GLOBAL uint* scratch) {
  for (int i = 0; i < 2048; i++) scratch[i] = 0u;
  Scene s;
#define POINT_AT_ZEROS(s, name, record, least, what) s.name = (GLOBAL const record*)scratch;
  SCENE_TABLES(POINT_AT_ZEROS, s)
#undef POINT_AT_ZEROS
  s.normals = (GLOBAL const VertexNormals*)(scratch + 64);
  s.quadrics = (GLOBAL const Quadric*)(scratch + 128);
  s.materials = (GLOBAL const Material*)(scratch + 192);
  s.lights = (GLOBAL const Light*)(scratch + 256);
  s.polygons = (GLOBAL const Polygon*)(scratch + 320);
  s.polygon_corners = (GLOBAL const PolygonCorner*)(scratch + 384);
  s.filter_table = (GLOBAL const float*)(scratch + 1024);
  s.header.features = FEATURE_ALL;
  s.header.families = EVERY_FAMILY;
  s.header.light_kinds = ALL_LIGHT_KINDS;
  s.header.environment = -1;
  s.header.tables.triangles.count = 1;
  s.header.tables.quadrics.count = 0;
  s.header.tables.lights.count = 1;
#ifdef EXTERNAL_TRACER
  s.tracer.context = 0;
  s.tracer.intersect = 0;
  s.tracer.occlude = 0;
#endif
  return s;
}

PENUMBRA_NAMESPACE_END
#endif
