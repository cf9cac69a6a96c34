// `penumbra-worker --measure-compile SCENE` measures how much OpenCL compile time is saved by compiling only
// what the scene needs. `penumbra info --compile` calls it.
#pragma once

namespace penumbra {

constexpr const char* kMeasureCompile = "--measure-compile";

/// The arguments after that option: a file with a serialised device scene and, optionally, a part of an
/// OpenCL device's name. Compiles the scene's own kernels and those with all features, each without caches
/// and up to the first result, and prints {"device", "own_seconds", "everything_seconds"}. Returns the exit
/// code.
int measure_compile(int count, char** arguments);

}  // namespace penumbra
