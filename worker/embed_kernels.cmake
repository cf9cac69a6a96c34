# The portable kernel sources as strings in the binary, made at build time.
set(PENUMBRA_EMBEDDED_KERNELS ${CMAKE_CURRENT_BINARY_DIR}/embedded_kernels.cpp)
list(TRANSFORM PENUMBRA_KERNEL_PATTERNS PREPEND ${CMAKE_SOURCE_DIR}/ OUTPUT_VARIABLE globs)
file(GLOB PENUMBRA_PORTABLE_SOURCES CONFIGURE_DEPENDS ${globs})
list(JOIN PENUMBRA_KERNEL_PATTERNS " " patterns)
add_custom_command(
  OUTPUT ${PENUMBRA_EMBEDDED_KERNELS}
  COMMAND ${CMAKE_COMMAND} -DROOT=${CMAKE_SOURCE_DIR} -DOUTPUT=${PENUMBRA_EMBEDDED_KERNELS}
          "-DPATTERNS=${patterns}" -DHEADER=worker/embedded_kernels.h
          -DSPACE=penumbra -DFUNCTION=embedded_kernels -P ${CMAKE_SOURCE_DIR}/worker/embed_files.cmake
  DEPENDS ${PENUMBRA_PORTABLE_SOURCES} ${CMAKE_SOURCE_DIR}/worker/embed_files.cmake
  COMMENT "Embedding the OpenCL kernels"
  VERBATIM)
