// The kernels for one instruction set: compiled several times, see CMakeLists.txt.
// Includes nothing from any standard library, so that no inline function of theirs is emitted for an
// instruction set the machine lacks.
#define EXTERNAL_TRACER
#include "kernels/block/block.h"

namespace penumbra {

void NATIVE_FUNCTION(const SceneHeader& header, const uint* words, const Tracer& tracer, const Unit& unit,
                     int first_pixel, int pixels, const Block& block, float* out, BadSamples* bad) {
  Scene scene = scene_of_unit(header, words, &unit);
  scene.tracer = tracer;
  render_block(&scene, &unit, first_pixel, pixels, &block, out, bad);
}

}  // namespace penumbra
