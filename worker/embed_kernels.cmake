# The portable kernel sources as strings in the binary, made at build time.
set(PENUMBRA_EMBEDDED_KERNELS ${CMAKE_CURRENT_BINARY_DIR}/embedded_kernels.cpp)
file(GLOB PENUMBRA_PORTABLE_SOURCES CONFIGURE_DEPENDS ${CMAKE_SOURCE_DIR}/kernels/*.h ${CMAKE_SOURCE_DIR}/kernels/*.cl)
add_custom_command(
  OUTPUT ${PENUMBRA_EMBEDDED_KERNELS}
  COMMAND ${CMAKE_COMMAND} -DROOT=${CMAKE_SOURCE_DIR} -DOUTPUT=${PENUMBRA_EMBEDDED_KERNELS}
          "-DPATTERNS=kernels/*.h kernels/*.cl" -DHEADER=worker/embedded_kernels.h
          -DSPACE=penumbra -DFUNCTION=embedded_kernels -P ${CMAKE_SOURCE_DIR}/worker/embed_files.cmake
  DEPENDS ${PENUMBRA_PORTABLE_SOURCES} ${CMAKE_SOURCE_DIR}/worker/embed_files.cmake
  COMMENT "Embedding the OpenCL kernels"
  VERBATIM)
