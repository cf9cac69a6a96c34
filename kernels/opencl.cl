// The OpenCL entry points. FEATURES and LANES come from the build.
#include "kernels/block.h"

/// One block per work item: pixels [item * block_pixels, ...) of the unit, counted from `first_pixel`. `f`,
/// `ints` and `slots` hold each work item's block one after the other; `bad` BAD_KINDS entries a work item.
__kernel void render_blocks(__global const SceneHeader* header, __global const uint* words, int x, int y,
                            int width, int height, uint first_sample, int sample_count, int first_pixel,
                            int block_pixels, int capacity, int slot_capacity, __global float* f,
                            __global int* ints, __global float* slots, __global float* out,
                            __global BadSamples* bad) {
  const int item = (int)get_global_id(0);
  Unit unit;
  unit.x = x;
  unit.y = y;
  unit.width = width;
  unit.height = height;
  unit.first_sample = first_sample;
  unit.sample_count = sample_count;
  const int pixel = first_pixel + item * block_pixels;
  const int pixels = min_i(block_pixels, width * height - pixel);
  if (pixels <= 0) return;
  Scene scene = make_scene(*header, words);
  Block block;
  block.f = f + (size_t)item * state_floats(scene.header.features) * capacity;
  block.i = ints + (size_t)item * STATE_INTS * capacity;
  block.slots = slots + (size_t)item * slot_floats(scene.header.features) * slot_capacity;
  block.capacity = capacity;
  block.slot_capacity = slot_capacity;
  block.probe = 0;
  render_block(&scene, &unit, pixel, pixels, &block, out, bad + BAD_KINDS * item);
}

/// The size and the field offsets of every shared struct as this device lays them out, in the order of
/// SHARED_STRUCTS: for comparison with the host's.
__kernel void report_layout(__global uint* out) {
  int n = 0;
#define REPORT_FIELD(type, name) out[n++] = (uint)(size_t) & (((__global REPORTED*)0)->name);
#define REPORT_STRUCT(name, fields) out[n++] = (uint)sizeof(name);
  SHARED_STRUCTS(REPORT_STRUCT)
#undef REPORT_STRUCT
#define REPORTED Triangle
  TRIANGLE_FIELDS(REPORT_FIELD)
#undef REPORTED
#define REPORTED VertexNormals
  VERTEX_NORMALS_FIELDS(REPORT_FIELD)
#undef REPORTED
#define REPORTED Quadric
  QUADRIC_FIELDS(REPORT_FIELD)
#undef REPORTED
#define REPORTED Material
  MATERIAL_FIELDS(REPORT_FIELD)
#undef REPORTED
#define REPORTED Light
  LIGHT_FIELDS(REPORT_FIELD)
#undef REPORTED
#define REPORTED Polygon
  POLYGON_FIELDS(REPORT_FIELD)
#undef REPORTED
#define REPORTED PolygonCorner
  POLYGON_CORNER_FIELDS(REPORT_FIELD)
#undef REPORTED
#define REPORTED BvhNode
  BVH_NODE_FIELDS(REPORT_FIELD)
#undef REPORTED
#define REPORTED TriangleLeaf
  TRIANGLE_LEAF_FIELDS(REPORT_FIELD)
#undef REPORTED
#define REPORTED QuadricLeaf
  QUADRIC_LEAF_FIELDS(REPORT_FIELD)
#undef REPORTED
#define REPORTED Corner
  CORNER_FIELDS(REPORT_FIELD)
#undef REPORTED
#define REPORTED SceneHeader
  SCENE_HEADER_FIELDS(REPORT_FIELD)
#undef REPORTED
}
