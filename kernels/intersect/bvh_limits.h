// Sizes of the intersectors' fixed arrays. The scene builder must respect them.
#ifndef PENUMBRA_BVH_LIMITS_H
#define PENUMBRA_BVH_LIMITS_H

#define BVH_MAX_DEPTH 26  // each level leaves at most BVH_WIDTH - 1 entries on the stack
// Limits of a scene that is intersected without BVH: distinct vertices, and triangles.
#define MAX_WHOLE_VERTICES 128
#define MAX_WHOLE_TRIANGLES 128

#endif
