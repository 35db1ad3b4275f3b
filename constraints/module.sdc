# Constraints of a module that is synthesised alone, without a file of its own: as compute_unit.sdc, but every port has
# registers around it. The flow sets raypool_clock_ns and raypool_driver before it reads this file.
create_clock -name clk -period $raypool_clock_ns [get_ports clk_i]
set away [expr {0.25 * $raypool_clock_ns}]
set inputs {}
foreach port [all_inputs] {
  if {[get_property $port full_name] ne "clk_i"} { lappend inputs $port }
}
set_input_delay $away -clock clk $inputs
set_output_delay $away -clock clk [all_outputs]
set_driving_cell -lib_cell $raypool_driver $inputs
