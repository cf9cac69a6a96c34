# The shaders of the analytic pass, from the same source as the kernels: preprocessed to one text each at build time,
# which ends up in the binary.
set(shader_texts ${CMAKE_CURRENT_BINARY_DIR}/analytic_shaders)
list(TRANSFORM PENUMBRA_KERNEL_PATTERNS PREPEND ${CMAKE_SOURCE_DIR}/ OUTPUT_VARIABLE shader_globs)
file(GLOB shader_parts CONFIGURE_DEPENDS ${shader_globs} ${CMAKE_CURRENT_SOURCE_DIR}/shaders/analytic*)
set(PENUMBRA_ANALYTIC_SHADERS ${CMAKE_CURRENT_BINARY_DIR}/analytic_shaders.cpp)
set(shader_outputs)
# analytic_shader(NAME SOURCE [DEFINITION...])
function(analytic_shader name source)
  set(output ${shader_texts}/${name})
  list(JOIN ARGN " " definitions)
  add_custom_command(
    OUTPUT ${output}
    COMMAND ${CMAKE_COMMAND} -DCOMPILER=${CMAKE_CXX_COMPILER} -DROOT=${CMAKE_SOURCE_DIR} -DOUTPUT=${output}
            -DSOURCE=${CMAKE_CURRENT_SOURCE_DIR}/shaders/${source} "-DDEFINITIONS=${definitions}"
            -P ${CMAKE_CURRENT_SOURCE_DIR}/preprocess_shader.cmake
    DEPENDS ${shader_parts} ${CMAKE_CURRENT_SOURCE_DIR}/preprocess_shader.cmake
    COMMENT "Preprocessing the shader ${name}"
    VERBATIM)
  set(shader_outputs ${shader_outputs} ${output} PARENT_SCOPE)
endfunction()

foreach(name triangles.vert triangles.frag quadrics.vert quadrics.frag screen.vert)
  analytic_shader(${name} analytic_${name})
endforeach()
analytic_shader(shade_diffuse.frag analytic_shade.frag)
analytic_shader(shade_phong.frag analytic_shade.frag PENUMBRA_PHONG)
analytic_shader(shade_diffuse_ltc.frag analytic_shade.frag PENUMBRA_LTC)
analytic_shader(shade_phong_ltc.frag analytic_shade.frag PENUMBRA_PHONG PENUMBRA_LTC)

add_custom_command(
  OUTPUT ${PENUMBRA_ANALYTIC_SHADERS}
  COMMAND ${CMAKE_COMMAND} -DROOT=${shader_texts} -DOUTPUT=${PENUMBRA_ANALYTIC_SHADERS} "-DPATTERNS=*.vert *.frag"
          -DHEADER=gl/analytic_pass.h -DSPACE=penumbra -DFUNCTION=analytic_shaders
          -P ${CMAKE_SOURCE_DIR}/worker/embed_files.cmake
  DEPENDS ${shader_outputs} ${CMAKE_SOURCE_DIR}/worker/embed_files.cmake
  COMMENT "Embedding the shaders of the analytic pass"
  VERBATIM)
