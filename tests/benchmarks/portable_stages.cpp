// The portable intersector's stages for one instruction set: see portable_stages.h.
#include "kernels/block/block_trace.h"

namespace penumbra {

void STAGE_FUNCTION(const SceneHeader& header, const uint* words, bool occlude, bool together,
                    const PathState* paths, int count) {
  const Scene scene = make_scene(header, words);
  if (occlude)
    occlude_block(&scene, paths, count);
  else
    intersect_block(&scene, paths, count, together);
}

}  // namespace penumbra
