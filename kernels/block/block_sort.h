// Sorts paths by the family of the BSDF that they hit. In scenes with several families, the lanes of a group
// then mostly share one, and few groups evaluate several. Images do not depend on the order.
#ifndef PENUMBRA_BLOCK_SORT_H
#define PENUMBRA_BLOCK_SORT_H
#include "kernels/block/path_state.h"
#include "kernels/intersect/surface.h"

PENUMBRA_NAMESPACE_BEGIN

#if LANES > 1
  #define MAX_FAMILIES 64

/// The family of each hit: that of the primitive's front, or of its back if the front is black, since the
/// side is not known yet. FAMILY_BLACK for rays that hit nothing.
STAGE void find_hit_families(const PRIVATE Scene* scene, const PRIVATE PathState* paths, int count,
                             GLOBAL int* RESTRICT families) {
  for (int i = 0; i < count; i += LANES) {
    LANE_LOOP
      for (int j = i; j < i + LANES; j++) {
        const int hit = get_hit(paths, j);
        const SideMaterials sides = side_materials(scene, hit);
        const int side = sides.front > 0 ? sides.front : sides.back;
        const int family = scene->materials[side].family;
        families[j] = hit >= 0 ? family : FAMILY_BLACK;
      }
  }
}

/// Replaces the families by those of chosen leaves.
STAGE void find_leaf_families(const PRIVATE Scene* scene, const PRIVATE PathState* paths, int count,
                              GLOBAL int* RESTRICT families) {
  for (int i = 0; i < count; i += LANES) {
    LANE_LOOP
      for (int j = i; j < i + LANES; j++) {
        const int leaf = get_material(paths, j), plain = families[j];
        const int family = scene->materials[leaf >= 0 ? leaf : 0].family;
        families[j] = leaf >= 0 ? family : plain;
      }
  }
}

/// Lists the lanes by family; the sort is stable. Returns whether the order differs from the current one.
STAGE bool order_by_family(const GLOBAL int* RESTRICT families, int count, GLOBAL int* RESTRICT order) {
  int starts[MAX_FAMILIES];
  for (int k = 0; k < MAX_FAMILIES; k++) starts[k] = 0;
  for (int i = 0; i < count; i++) starts[families[i]]++;
  int sum = 0;
  for (int k = 0; k < MAX_FAMILIES; k++) {
    const int size = starts[k];
    starts[k] = sum;
    sum += size;
  }
  bool changed = false;
  for (int i = 0; i < count; i++) {
    const int to = starts[families[i]]++;
    order[to] = i;
    changed = changed | (to != i);
  }
  return changed;
}

/// Lane m gets the value of lane order[m]. `field` and `buffer` are not RESTRICT: the generated code also
/// names the buffers, which are fields that never move, and g++ would see one array in both places.
STAGE void reorder_float(GLOBAL float* field, const GLOBAL int* RESTRICT order, int count,
                         GLOBAL float* buffer) {
  LANE_LOOP
    for (int m = 0; m < count; m++) buffer[m] = field[order[m]];
  LANE_LOOP
    for (int m = 0; m < count; m++) field[m] = buffer[m];
}
STAGE void reorder_int(GLOBAL int* field, const GLOBAL int* RESTRICT order, int count, GLOBAL int* buffer) {
  LANE_LOOP
    for (int m = 0; m < count; m++) buffer[m] = field[order[m]];
  LANE_LOOP
    for (int m = 0; m < count; m++) field[m] = buffer[m];
}
  #define REORDER_float(field) reorder_float(field, order, count, floats)
  #define REORDER_int(field) reorder_int(field, order, count, ints)
  #define REORDER_bool(field) reorder_int(field, order, count, ints)
  #define REORDER_vec3(field) \
    for (int k = 0; k < 3; k++) REORDER_float((field) + k * paths->capacity)

/// Sorts the paths whose rays were just intersected.
CALLED_FN void sort_by_family(const PRIVATE Scene* scene, const PRIVATE PathState* paths, int count) {
  const ulong features = SCENE_FEATURES(&scene->header);
  const GLOBAL int* order = paths->going;
  GLOBAL float* floats = paths->sort_buffer;
  GLOBAL int* ints = paths->finished;
  find_hit_families(scene, paths, count, paths->finished);
  if (NEEDS(scene, NESTED)) find_leaf_families(scene, paths, count, paths->finished);
  if (!order_by_family(paths->finished, count, paths->going)) return;
  REORDER_int(paths->hit);
  if (NEEDS(scene, INSTANCES)) REORDER_int(paths->hit_instance);
  #define REORDER_FIELD(type, name, needs, travels) \
    if (MAY_MOVE(needs, travels) && is_moved(features, needs, travels)) REORDER_##type(paths->name);
  PATH_FIELDS(REORDER_FIELD)
  #undef REORDER_FIELD
}
#endif

PENUMBRA_NAMESPACE_END
#endif
