# Tests that `make test` leaves to `make test-long`. They stand in ten shares of about the same length; .ci/run takes
# one, another one with each commit (docs/develop/verification.md). A test of the K-th share has the one label long-K.
set(RAYPOOL_SHARES 10)
foreach(share RANGE 1 ${RAYPOOL_SHARES})
  set_property(GLOBAL PROPERTY RAYPOOL_SHARE_${share} 0)
endforeach()
# Programs and filters that raypool_cases() has been given, which the test `shares` compares with what there is.
set(RAYPOOL_LONG_CASES ${CMAKE_BINARY_DIR}/long_cases.txt)
file(WRITE ${RAYPOOL_LONG_CASES} "")

# raypool_share(VARIABLE SECONDS): the label of the share that has the least so far, which gets so many
# processor-seconds more.
function(raypool_share variable seconds)
  set(least 1)
  foreach(share RANGE 1 ${RAYPOOL_SHARES})
    get_property(taken GLOBAL PROPERTY RAYPOOL_SHARE_${share})
    get_property(smallest GLOBAL PROPERTY RAYPOOL_SHARE_${least})
    if(taken LESS smallest)
      set(least ${share})
    endif()
  endforeach()
  get_property(taken GLOBAL PROPERTY RAYPOOL_SHARE_${least})
  math(EXPR taken "${taken} + ${seconds}")
  set_property(GLOBAL PROPERTY RAYPOOL_SHARE_${least} ${taken})
  set(${variable} long-${least} PARENT_SCOPE)
endfunction()

# What takes longest of all and is declared last has its share before the others, which then fill up evenly.
raypool_share(RAYPOOL_SHARE_OF_NEW_ALU 500)
raypool_share(RAYPOOL_SHARE_OF_FIRST_CHANGE 450)
raypool_share(RAYPOOL_SHARE_OF_FOLLOW 400)

# raypool_long(SECONDS TEST...): all of these tests, each of about so many processor-seconds from bare, in one share.
function(raypool_long seconds)
  list(LENGTH ARGN tests)
  math(EXPR seconds "${seconds} * ${tests}")
  raypool_share(label ${seconds})
  set_tests_properties(${ARGN} PROPERTIES LABELS ${label})
endfunction()

# raypool_cases(PROGRAM [EXCEPT FILTER] [LONG SECONDS FILTER...] [PROPERTIES PROPERTY VALUE...]): a test for each test
# of a program of GoogleTest that its filter EXCEPT does not leave out. Those of LONG, which take so many
# processor-seconds together, go into one share of the long tests; `make test` runs all others.
function(raypool_cases program)
  cmake_parse_arguments(CASES "" "EXCEPT" "LONG;PROPERTIES" ${ARGN})
  set(how NO_PRETTY_VALUES WORKING_DIRECTORY ${CMAKE_SOURCE_DIR} DISCOVERY_TIMEOUT 60)
  set(left_out ${CASES_EXCEPT})
  if(CASES_LONG)
    list(POP_FRONT CASES_LONG seconds)
    raypool_share(label ${seconds})
    foreach(filter IN LISTS CASES_LONG)
      file(APPEND ${RAYPOOL_LONG_CASES} "${program} ${filter}\n")
    endforeach()
    list(JOIN CASES_LONG : long)
    set(filter ${long})
    if(CASES_EXCEPT)
      string(APPEND filter -${CASES_EXCEPT})
    endif()
    gtest_discover_tests(${program} ${how} TEST_FILTER ${filter} PROPERTIES ${CASES_PROPERTIES} LABELS ${label})
    list(APPEND left_out ${long})
  endif()
  list(JOIN left_out : left_out)
  gtest_discover_tests(${program} ${how} TEST_FILTER *-${left_out} PROPERTIES ${CASES_PROPERTIES})
endfunction()

# raypool_built_test(NAME SECONDS TARGET COMMAND [ARGUMENT...]): a long test that builds the program TARGET, which
# nothing else does, before it runs the command.
function(raypool_built_test name seconds target)
  set_target_properties(${target} PROPERTIES EXCLUDE_FROM_ALL TRUE)
  add_test(NAME ${name} COMMAND ${CMAKE_SOURCE_DIR}/scripts/built_test.sh ${CMAKE_BINARY_DIR} ${target} ${ARGN}
    WORKING_DIRECTORY ${CMAKE_SOURCE_DIR})
  set_tests_properties(${name} PROPERTIES TIMEOUT 3600)
  raypool_long(${seconds} ${name})
endfunction()

# raypool_long_program(SECONDS TARGET [ARGUMENT...]): the test TARGET is that program.
function(raypool_long_program seconds target)
  raypool_built_test(${target} ${seconds} ${target} $<TARGET_FILE:${target}> ${ARGN})
endfunction()
