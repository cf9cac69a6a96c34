// Sizes of the intersectors' fixed arrays. The scene builder must respect them.
#ifndef PENUMBRA_BVH_LIMITS_H
#define PENUMBRA_BVH_LIMITS_H

// The numbers of leaves: those of triangles count from 0, those of quadrics and instances from these on.
#define FIRST_QUADRIC_LEAF 0x20000000
#define FIRST_INSTANCE_LEAF 0x40000000
#define BVH_MAX_DEPTH 26  // each level leaves at most BVH_WIDTH - 1 entries on the stack
// Limits of a scene that is intersected without BVH: distinct vertices, and triangles.
#define MAX_WHOLE_VERTICES 128
#define MAX_WHOLE_TRIANGLES 128

#endif
