# What computes: native code with or without Embree, or an OpenCL device.

include(${CMAKE_CURRENT_LIST_DIR}/embed_kernels.cmake)

add_library(penumbra_devices STATIC device.cpp native_device.cpp photon_maps.cpp search_choice.cpp embree_tracer.cpp opencl_device.cpp
                                    opencl_devices.cpp opencl_memory.cpp opencl_program.cpp opencl_session.cpp
                                    non_finite_source.cpp ${PENUMBRA_EMBEDDED_KERNELS})
target_link_libraries(penumbra_devices PUBLIC penumbra_kernels_host penumbra_cache PRIVATE penumbra_native_kernels embree
                                       OpenCL::OpenCL Threads::Threads fmt::fmt)
target_compile_definitions(penumbra_devices PRIVATE CL_TARGET_OPENCL_VERSION=120)
reuse_headers(common penumbra_devices)
