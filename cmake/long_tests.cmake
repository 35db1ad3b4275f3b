# Tests that `make test` leaves to `make test-long`. They stand in ten shares of about the same length; .ci/run takes
# one, another one with each commit (docs/verification.md).
set(RAYPOOL_SHARES 10)
foreach(share RANGE 1 ${RAYPOOL_SHARES})
  set_property(GLOBAL PROPERTY RAYPOOL_SHARE_${share} 0)
endforeach()

# raypool_long(SECONDS TEST...): each of these tests takes about so many processor-seconds from bare; all go into the
# share that has the least so far.
function(raypool_long seconds)
  set(least 1)
  foreach(share RANGE 1 ${RAYPOOL_SHARES})
    get_property(taken GLOBAL PROPERTY RAYPOOL_SHARE_${share})
    get_property(smallest GLOBAL PROPERTY RAYPOOL_SHARE_${least})
    if(taken LESS smallest)
      set(least ${share})
    endif()
  endforeach()
  get_property(taken GLOBAL PROPERTY RAYPOOL_SHARE_${least})
  foreach(test IN LISTS ARGN)
    math(EXPR taken "${taken} + ${seconds}")
    set_property(TEST ${test} APPEND PROPERTY LABELS long share-${least})
  endforeach()
  set_property(GLOBAL PROPERTY RAYPOOL_SHARE_${least} ${taken})
endfunction()

# raypool_long_program(SECONDS TARGET [ARGUMENT...]): the test TARGET builds the program of that name, which nothing
# else does, and runs it.
function(raypool_long_program seconds target)
  set_target_properties(${target} PROPERTIES EXCLUDE_FROM_ALL TRUE)
  add_test(NAME ${target} COMMAND ${CMAKE_SOURCE_DIR}/scripts/built_test.sh ${CMAKE_BINARY_DIR} ${target}
    $<TARGET_FILE:${target}> ${ARGN} WORKING_DIRECTORY ${CMAKE_SOURCE_DIR})
  set_tests_properties(${target} PROPERTIES TIMEOUT 3600)
  raypool_long(${seconds} ${target})
endfunction()
