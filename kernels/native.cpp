// The kernels for one instruction set. This file is compiled several times, see CMakeLists.txt. It includes
// nothing from a standard library: inline functions of one might otherwise be emitted for an instruction set
// that the machine lacks.
#define EXTERNAL_TRACER
#include "kernels/block/block.h"

namespace penumbra {

void RENDER_FUNCTION(const SceneHeader& header, const uint* words, const uint* photons, const Tracer& tracer,
                     const Unit& unit, int first_pixel, int pixels, const Block& block, float* out,
                     BadSamples* bad) {
  Scene scene = scene_of_unit(header, words, photons, &unit);
  scene.tracer = tracer;
  render_block(&scene, &unit, first_pixel, pixels, &block, out, bad);
}

void TRACE_FUNCTION(const SceneHeader& header, const uint* words, const Tracer& tracer,
                    const PhotonTask& task, int first, int count, const Block& block,
                    const PhotonStore& store) {
  Scene scene = make_scene(header, words);
  scene.tracer = tracer;
  trace_photons(&scene, &task, first, count, &block, store);
}

}  // namespace penumbra
