# Registers the tests of an executable with CTest, which includes this as it starts: the quick ones by suite, since starting
# a process takes as long as many tests, and the slow ones one by one, with the label slow. Kept until the executable changes.
#
# executable, emulator: what runs it
# slow: the filter of GoogleTest for the slow tests
# timeout: of a test, in seconds; a suite has five times as long
# labels, kept_file

# tests_of FILTER VARIABLE: the names of the executable's tests that a filter lets through.
function(tests_of filter variable)
  execute_process(COMMAND ${executable} --gtest_list_tests --gtest_filter=${filter} TIMEOUT 60
                  OUTPUT_VARIABLE text ERROR_VARIABLE error RESULT_VARIABLE status)
  if(NOT status EQUAL 0)
    message(FATAL_ERROR "${executable} does not list its tests: ${status}\n${text}${error}")
  endif()
  string(REGEX REPLACE " +#[^\n]*" "" text "${text}")  # of parameters
  string(REPLACE "\n" ";" lines "${text}")
  set(tests "")
  foreach(line IN LISTS lines)
    if(line MATCHES "^  (.+)$")
      list(APPEND tests "${suite}.${CMAKE_MATCH_1}")
    elseif(line MATCHES "^([^ ]+)\\.$")
      set(suite "${CMAKE_MATCH_1}")
    endif()
  endforeach()
  set(${variable} "${tests}" PARENT_SCOPE)
endfunction()

# add NAME FILTER TIMEOUT LABELS: a test of CTest. It is skipped where it passed and GoogleTest ends with what it skipped.
function(add name filter timeout labels)
  list(JOIN command "]==] [==[" words)
  file(APPEND "${kept_file}" "add_test([==[${name}]==] [==[${words}]==] [==[--gtest_filter=${filter}]==])\n"
    "set_tests_properties([==[${name}]==] PROPERTIES TIMEOUT ${timeout} LABELS \"${labels}\"\n"
    "  SKIP_REGULAR_EXPRESSION [==[\\[  SKIPPED \\] [^ \n]*\n*$]==])\n")
endfunction()

if(NOT EXISTS "${kept_file}" OR NOT "${kept_file}" IS_NEWER_THAN "${executable}"
   OR NOT "${kept_file}" IS_NEWER_THAN "${description}" OR NOT "${kept_file}" IS_NEWER_THAN "${CMAKE_CURRENT_LIST_FILE}")
  tests_of("${slow}" slow_tests)
  tests_of("-${slow}" quick_tests)
  set(command ${emulator} ${executable})
  set(slow_labels ${labels} slow)
  file(WRITE "${kept_file}" "")
  foreach(test IN LISTS slow_tests)
    add("${test}" "${test}" ${timeout} "${slow_labels}")
  endforeach()
  list(TRANSFORM quick_tests REPLACE "\\..*" "" OUTPUT_VARIABLE suites)
  list(REMOVE_DUPLICATES suites)
  math(EXPR suite_timeout "5 * ${timeout}")
  foreach(suite IN LISTS suites)
    set(others "${slow_tests}")
    list(FILTER others INCLUDE REGEX "^${suite}\\.")
    list(JOIN others ":" others)
    add("${suite}" "${suite}.*:-${others}" ${suite_timeout} "${labels}")
  endforeach()
endif()
include("${kept_file}")
