// `penumbra-worker --measure-compile SCENE`: what leaving out saves of the OpenCL compiler's time. `penumbra
// info
// --compile` asks for it.
#pragma once

namespace penumbra {

constexpr const char* kMeasureCompile = "--measure-compile";

/// The arguments after that option: a file with a serialised device scene, and perhaps a part of an OpenCL
/// device's name. Compiles the scene's own kernels and those with everything, each from nothing and up to its
/// first result, and prints {"device", "own_seconds", "everything_seconds"}. Returns the exit code.
int measure_compile(int count, char** arguments);

}  // namespace penumbra
