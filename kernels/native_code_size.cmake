# Writes OUT, C++ that lists the sizes of object files: cmake -DSIZE=… -DOUT=… -DNAMES=a,b -DOBJECTS=a.o,b.o -P this.
# NAMES are those of instruction sets.
string(REPLACE "," ";" NAMES "${NAMES}")
string(REPLACE "," ";" OBJECTS "${OBJECTS}")
set(rows "")
foreach(name object IN ZIP_LISTS NAMES OBJECTS)
  execute_process(COMMAND ${SIZE} -A -d ${object} OUTPUT_VARIABLE sections COMMAND_ERROR_IS_FATAL ANY)
  set(bytes 0)
  string(REGEX MATCHALL "\n\\.(text|rodata)[^ ]* +[0-9]+" lines "${sections}")
  foreach(line IN LISTS lines)
    string(REGEX REPLACE ".* " "" section_bytes "${line}")
    math(EXPR bytes "${bytes} + ${section_bytes}")
  endforeach()
  string(APPEND rows "    {\"${name}\", ${bytes}},\n")
endforeach()
file(WRITE ${OUT} "// Made by native_code_size.cmake.
#include \"kernels/host/native_kernels.h\"

#include <string_view>

namespace penumbra {
namespace {

struct Row {
  std::string_view name;
  std::uint64_t bytes;
};
constexpr Row kRows[] = {
${rows}};

}  // namespace

std::uint64_t native_code_bytes(const NativeKernel& kernel) {
  for (const Row& row : kRows)
    if (row.name == isa_name(kernel.isa)) return row.bytes;
  return 0;
}

}  // namespace penumbra
")
