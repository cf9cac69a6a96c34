// Portable kernel source compiled as GLSL 3.30, for closed forms on the screen. A C preprocessor makes one
// text of it at build time. Shared code has no pointers, no casts except the macros', and no `const` for
// values that depend on a fragment. It runs in single precision, the only one that GLSL 3.30 has.
#pragma once

#define PENUMBRA_NAMESPACE_BEGIN
#define PENUMBRA_NAMESPACE_END

#define FN
#define double float
#define vec3d vec3
// In GLSL 3.30 a `const` local variable must be a constant expression.
#define const

#define STRUCT(name) struct name
#define BOTH(a, b) ((a) && (b))
#define EITHER(a, b) ((a) || (b))
#define TO_INT(x) int(x)
#define TO_UINT(x) uint(x)
#define TO_FLOAT(x) float(x)

#define SQRT(x) sqrt(x)
#define FABS(x) abs(x)
#define FLOAT_BITS(x) floatBitsToUint(x)
#define BITS_FLOAT(x) uintBitsToFloat(x)
#define SQRT_D(x) sqrt(x)
#define FABS_D(x) abs(x)
