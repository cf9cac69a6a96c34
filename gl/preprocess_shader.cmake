# Makes one shader text: what the C preprocessor COMPILER makes of SOURCE with the kernels' headers, into OUTPUT.
# DEFINITIONS: names to define, separated by blanks.
cmake_minimum_required(VERSION 3.25)

separate_arguments(DEFINITIONS)
list(TRANSFORM DEFINITIONS PREPEND -D)
execute_process(
  COMMAND ${COMPILER} -E -P -x c++ -nostdinc -DPENUMBRA_GLSL ${DEFINITIONS} -I${ROOT} ${SOURCE}
  OUTPUT_VARIABLE text
  COMMAND_ERROR_IS_FATAL ANY)
# lang_glsl.h takes `const` away; a table that is the same for all fragments keeps it by another name.
file(WRITE ${OUTPUT} "#version 330 core\n#define CONSTANT const\n${text}")
