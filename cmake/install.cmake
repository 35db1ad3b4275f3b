# What `cmake --install` copies: component program (raypool, its data, man page, completion) and component
# development (the model as a library). The data keep the places they have in the checkout, since
# scripts/verilate.sh builds units from them.
include(CMakePackageConfigHelpers)
set(data ${CMAKE_INSTALL_DATADIR}/raypool)

install(TARGETS raypool RUNTIME COMPONENT program)
install(DIRECTORY configs schemas shaders examples rtl DESTINATION ${data} COMPONENT program)
install(PROGRAMS scripts/verilate.sh DESTINATION ${data}/scripts COMPONENT program)
# What a Verilated unit or chip is compiled with.
foreach(source sim/rtl/rtl_unit.cpp sim/rtl/rtl_chip.cpp sim/rtl/unit_library.hpp sim/rtl/chip_library.hpp
    sim/rtl/verilated_design.hpp sim/rtl/probes.vlt sim/rtl/chip_probes.vlt sim/rtl/shared_modules.vlt
    cpp_model/bits.hpp cpp_model/enum_array.hpp
    cpp_model/isa/isa.hpp cpp_model/isa/counters.hpp cpp_model/isa/input_error.hpp cpp_model/config/configuration.hpp
    cpp_model/config/parameters.hpp cpp_model/machine/traverser/box_ray.hpp cpp_model/machine/compute/compute_unit.hpp
    cpp_model/machine/compute/compute_unit.cpp cpp_model/machine/chip/chip_device.hpp
    cpp_model/machine/chip/chip_device.cpp
    cpp_model/machine/common/memory.hpp cpp_model/machine/chip/memory_port.hpp cpp_model/machine/common/packages.hpp
    cpp_model/machine/common/pipe_items.hpp cpp_model/machine/common/port_cycles.hpp
    cpp_model/machine/common/ram_queue.hpp cpp_model/machine/common/memory_line.hpp
    cpp_model/machine/traverser/tree_lines.hpp
    cpp_model/machine/chip/ray_kernel.hpp
    cpp_model/machine/traverser/ray_setup.hpp cpp_model/machine/traverser/traverser_work.hpp
    cpp_model/machine/traverser/tree_fault.hpp
    cpp_model/machine/traverser/tree_setup.hpp
    cpp_model/machine/traverser/triangle_ray.hpp)
  cmake_path(GET source PARENT_PATH folder)
  install(FILES ${source} DESTINATION ${data}/${folder} COMPONENT program)
endforeach()
install(FILES ${CMAKE_BINARY_DIR}/share/raypool.1.gz DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 COMPONENT program)
install(FILES ${CMAKE_BINARY_DIR}/share/raypool.bash DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions
  RENAME raypool COMPONENT program)
install(FILES ${CMAKE_BINARY_DIR}/share/raypool.zsh DESTINATION ${CMAKE_INSTALL_DATADIR}/zsh/vendor-completions
  RENAME _raypool COMPONENT program)
install(FILES ${CMAKE_BINARY_DIR}/share/raypool.fish DESTINATION ${CMAKE_INSTALL_DATADIR}/fish/vendor_completions.d
  COMPONENT program)
install(FILES LICENSE DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/raypool RENAME copyright COMPONENT program)

# The libraries by the names that others link them by: raypool::model brings all but the lockstep.
set(libraries raypool_include raypool_files raypool_isa raypool_config raypool_arith raypool_kernel raypool_machine
  raypool_lockstep)
foreach(library IN LISTS libraries)
  string(REPLACE raypool_ "" name ${library})
  string(REPLACE machine model name ${name})
  set_target_properties(${library} PROPERTIES EXPORT_NAME ${name})
  add_library(raypool::${name} ALIAS ${library})
endforeach()
install(TARGETS ${libraries} EXPORT raypool ARCHIVE COMPONENT development)
# Among themselves the headers are included as in the checkout; users write <raypool/machine/compute/model.hpp>.
install(DIRECTORY cpp_model/ sim/lockstep DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/raypool COMPONENT development
        FILES_MATCHING PATTERN "*.hpp" PATTERN "test_*.hpp" EXCLUDE)
set(package ${CMAKE_INSTALL_LIBDIR}/cmake/raypool)
install(EXPORT raypool FILE raypool-targets.cmake NAMESPACE raypool:: DESTINATION ${package} COMPONENT development)
configure_package_config_file(cmake/raypool-config.cmake.in ${CMAKE_BINARY_DIR}/raypool-config.cmake
  INSTALL_DESTINATION ${package})
write_basic_package_version_file(${CMAKE_BINARY_DIR}/raypool-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_BINARY_DIR}/raypool-config.cmake ${CMAKE_BINARY_DIR}/raypool-config-version.cmake
  DESTINATION ${package} COMPONENT development)
