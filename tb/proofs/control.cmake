# The quick proofs of the control logic, one test for each checker; `make proofs`
# runs all, and shows that each can fail.
find_program(YOSYS yosys)
find_program(YOSYS_ABC yosys-abc)
if(YOSYS AND YOSYS_ABC)
  file(GLOB checkers CONFIGURE_DEPENDS ${CMAKE_CURRENT_LIST_DIR}/control/*.v)
  foreach(checker IN LISTS checkers)
    file(STRINGS ${checker} slow REGEX "^// @slow")
    if(NOT slow)
      cmake_path(GET checker STEM name)
      add_test(NAME proof_${name} COMMAND ${CMAKE_CURRENT_LIST_DIR}/control.sh --quick ${name})
      # One of them takes minutes, which it shall not do in the end, when the other core has nothing left to do.
      set_tests_properties(proof_${name} PROPERTIES TIMEOUT 600 COST 300)
    endif()
  endforeach()
else()
  message(STATUS "yosys was not found: the proofs of the control logic are left out (Debian package: yosys)")
endif()
