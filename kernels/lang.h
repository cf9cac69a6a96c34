// Picks the language header. Portable sources include this first and nothing from any standard library.
#ifndef PENUMBRA_LANG_H
#define PENUMBRA_LANG_H
#ifdef __OPENCL_VERSION__
  #include "kernels/lang_opencl.h"
#else
  #include "kernels/lang_cpp.h"
#endif
#endif
