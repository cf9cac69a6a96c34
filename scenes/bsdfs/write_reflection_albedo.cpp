// Writes the curves of reflection_albedo, which take a tenth of a second, as a list of C++ numbers. The build
// runs it once, so that no render has to compute them.
#include <cstdio>

#include "scenes/bsdfs/reflection_albedo.h"

int main() {
  for (const float value : penumbra::reflection_albedo_curves()) std::printf("%af,\n", double(value));
}
