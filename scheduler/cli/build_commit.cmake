# Writes OUTPUT with the commit of the source in SOURCE, if it is another one: what includes it is compiled then, and no
# other file. Changes of files that git knows are said; outside of a clone it is "unknown".
find_program(GIT git)
set(commit unknown)
if(GIT)
  execute_process(COMMAND ${GIT} -c safe.directory=* describe --always --dirty=+changes --abbrev=12 --exclude *
                  WORKING_DIRECTORY ${SOURCE} OUTPUT_VARIABLE found RESULT_VARIABLE failed ERROR_QUIET
                  OUTPUT_STRIP_TRAILING_WHITESPACE)
  if(NOT failed AND found)
    set(commit ${found})
  endif()
endif()
set(text "#define PENUMBRA_COMMIT \"${commit}\"\n")
set(before "")
if(EXISTS ${OUTPUT})
  file(READ ${OUTPUT} before)
endif()
if(NOT before STREQUAL text)
  file(WRITE ${OUTPUT} "${text}")
endif()
