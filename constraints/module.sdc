# Constraints of any module: every port has registers around it, and a quarter of the cycle is left to what lies there.
# Before layout: no wires, an ideal clock. The flow sets raypool_clock_ns and raypool_driver before it reads this file,
# and then reads that of the module, if there is one.
create_clock -name clk -period $raypool_clock_ns [get_ports clk_i]
set away [expr {0.25 * $raypool_clock_ns}]
set inputs {}
foreach port [all_inputs] {
  if {[get_property $port full_name] ne "clk_i"} { lappend inputs $port }
}
set_input_delay $away -clock clk $inputs
set_output_delay $away -clock clk [all_outputs]
set_driving_cell -lib_cell $raypool_driver $inputs
