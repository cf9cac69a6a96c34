# The portable kernel source as one string in the binary: kernels/opencl.cl with its includes resolved, at build time.
set(PENUMBRA_EMBEDDED_KERNELS ${CMAKE_CURRENT_BINARY_DIR}/embedded_kernels.cpp)
file(GLOB PENUMBRA_PORTABLE_HEADERS CONFIGURE_DEPENDS ${CMAKE_SOURCE_DIR}/kernels/*.h)
add_custom_command(
  OUTPUT ${PENUMBRA_EMBEDDED_KERNELS}
  COMMAND ${CMAKE_COMMAND} -DROOT=${CMAKE_SOURCE_DIR} -DSOURCE=kernels/opencl.cl -DOUTPUT=${PENUMBRA_EMBEDDED_KERNELS}
          -P ${CMAKE_SOURCE_DIR}/worker/embed_kernels_script.cmake
  DEPENDS ${CMAKE_SOURCE_DIR}/kernels/opencl.cl ${PENUMBRA_PORTABLE_HEADERS}
          ${CMAKE_SOURCE_DIR}/worker/embed_kernels_script.cmake
  COMMENT "Embedding the OpenCL kernels"
  VERBATIM)
