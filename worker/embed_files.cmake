# Writes files as a C++ table of names and texts, as they are: those below ROOT that match PATTERNS (separated by
# blanks), into OUTPUT, as what SPACE::FUNCTION() of HEADER returns.
cmake_minimum_required(VERSION 3.25)

separate_arguments(PATTERNS)
list(TRANSFORM PATTERNS PREPEND ${ROOT}/)
file(GLOB files RELATIVE ${ROOT} ${PATTERNS})
set(output "// Generated; do not edit.\n#include \"${HEADER}\"\n\nnamespace ${SPACE} {\n\nstd::span<const EmbeddedFile> ${FUNCTION}() {\nusing namespace std::string_view_literals;\nstatic constexpr EmbeddedFile kFiles[] = {\n")
foreach(file IN LISTS files)
  file(READ ${ROOT}/${file} text)
  string(APPEND output "{\"${file}\",\n")
  # Compilers limit the length of one literal; neighbours are joined. Lengths known to the literals (sv) cost no
  # steps of constant evaluation, which are limited too.
  string(LENGTH "${text}" length)
  set(at 0)
  while(at LESS length)
    string(SUBSTRING "${text}" ${at} 8000 part)
    string(APPEND output "R\"kernel(${part})kernel\"sv\n")
    math(EXPR at "${at} + 8000")
  endwhile()
  # With the suffix compilers know the length; counting it would take them more steps than constants may.
  string(APPEND output "\"\"sv},\n")
endforeach()
string(APPEND output "};\nreturn kFiles;\n}\n\n}  // namespace ${SPACE}\n")
file(WRITE ${OUTPUT} "${output}")
