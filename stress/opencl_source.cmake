# Writes the quantities' sources as C++ strings, as they are: FILES below ROOT into OUTPUT.
cmake_minimum_required(VERSION 3.25)

set(output "// Generated from stress/; do not edit.\n#include \"stress/opencl_source.h\"\n\nnamespace penumbra::stress {\nnamespace {\n\nconstexpr EmbeddedFile kFiles[] = {\n")
foreach(file stress/quantities.cl stress/quantities.h stress/quantity_list.h)
  file(READ ${ROOT}/${file} text)
  string(APPEND output "{\"${file}\",\n")
  # Compilers limit the length of one literal; neighbours are joined.
  string(LENGTH "${text}" length)
  set(at 0)
  while(at LESS length)
    string(SUBSTRING "${text}" ${at} 8000 part)
    string(APPEND output "R\"kernel(${part})kernel\"\n")
    math(EXPR at "${at} + 8000")
  endwhile()
  string(APPEND output "},\n")
endforeach()
string(APPEND output "};\n\n}  // namespace\n\nstd::span<const EmbeddedFile> embedded_quantities() { return kFiles; }\n\n}  // namespace penumbra::stress\n")
file(WRITE ${OUTPUT} "${output}")
