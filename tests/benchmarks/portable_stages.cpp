// The portable intersector's stages for one instruction set and one kind of scene: see portable_stages.h.
#include "kernels/native_variants.h"

#include "kernels/block/block_trace.h"

namespace penumbra {

void STAGE_FUNCTION(const SceneHeader& header, const uint* words, bool occlude, const PathState* paths,
                    int count) {
  const Scene scene = make_scene(header, words);
  (occlude ? occlude_block : intersect_block)(&scene, paths, count);
}

}  // namespace penumbra
