// The kernels for one instruction set. This file is compiled several times, see CMakeLists.txt. It includes
// nothing from a standard library: inline functions of one might otherwise be emitted for an instruction set
// that the machine lacks.
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
