// The quantities for one instruction set: compiled several times, see CMakeLists.txt. Includes nothing from
// any standard library, so that no inline function of theirs is emitted for an instruction set the machine
// lacks.
#include "scheduler/stress/quantities.h"

namespace penumbra {

void NATIVE_FUNCTION(int id, const double* in, double* out, uint* scratch) { quantity(id, in, out, scratch); }

}  // namespace penumbra
