# Bench of what stands between the units of a multiprocessor: class V<module>_<units>.
add_executable(arbiters_test ${CMAKE_CURRENT_LIST_DIR}/arbiters_test.cpp)
target_link_libraries(arbiters_test PRIVATE GTest::gtest_main)
target_include_directories(arbiters_test SYSTEM PRIVATE ${VERILATOR_ROOT}/include)  # its headers warn
function(raypool_arbiter_model module units)
  verilate(arbiters_test SOURCES ${RAYPOOL_RTL}/${module}.v PREFIX V${module}_${units} TOP_MODULE ${module}
    OPT_SLOW -w OPT_FAST -O2 -w
    OPT_GLOBAL -O1 -w VERILATOR_ARGS -O3 --default-language 1364-2005 -y ${RAYPOOL_RTL} ${ARGN})
endfunction()
foreach(units 2 4)
  raypool_arbiter_model(port_arbiter ${units} -GCOUNT=${units} -GWIDTH=16)
  raypool_arbiter_model(import_arbiter ${units} -GUNITS=${units})
  raypool_arbiter_model(block_scheduler ${units} -GUNITS=${units})
endforeach()
gtest_discover_tests(arbiters_test DISCOVERY_TIMEOUT 60)
