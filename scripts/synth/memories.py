"""What a memory block costs and how long it takes: the stated model of constraints/memories.json,
and a Liberty file for the timer.
"""
import json
import math
import os
from dataclasses import dataclass

from . import macros
from .library import ROOT

PORT_KINDS = {"ram_1rw": "1rw", "ram_1r1w": "1r1w", "ram_2r1w": "2r1w"}


@dataclass
class Price:
    """um2 in the library of the report: as priced, and the ends of the band."""

    bits: int
    nominal: float
    low: float
    high: float


class MemoryModel:
    """Prices are those of a 45 nm macro, another library pays as many NAND2 gates for a bit; but where a listed macro
    fits (of one port), it has its own area and times.
    """

    def __init__(self, library, listed=()):
        with open(os.path.join(ROOT, "constraints", "memories.json"), encoding="utf-8") as file:
            self.data = json.load(file)
        self.library = library
        self.listed = listed
        self.scale = library.nand2_area / self.data["reference_nand2_um2"]

    def price_at_reference(self, kind):
        """um2 at 45 nm: (nominal, low, high)."""
        bits = kind.value("WIDTH") * kind.value("DEPTH")
        entry = self.data["ports"][PORT_KINDS[kind.base]]
        small = 1 + self.data["periphery"] / math.sqrt(bits)
        return bits, bits * entry["um2_a_bit"] * small, bits * entry["low"], bits * entry["high"]

    def macro(self, kind):
        """The listed macro that a memory is made of, or None."""
        return macros.fitting(self.listed, kind.value("WIDTH"), kind.value("DEPTH")) if kind.base == "ram_1rw" else None

    def price(self, kind):
        bits, nominal, low, high = self.price_at_reference(kind)
        macro = self.macro(kind)
        if macro:
            return Price(bits, macro.area, macro.area, macro.area)
        return Price(bits, nominal * self.scale, low * self.scale, high * self.scale)

    def access_ns(self, kind, fo4_ns):
        """Clock to output."""
        macro = self.macro(kind)
        if macro:
            return macro.access_ns
        model = self.data["access_fo4"]
        return fo4_ns * (
            model["fixed"]
            + model["a_doubling_of_depth"] * math.log2(max(2, kind.value("DEPTH")))
            + model["a_doubling_of_width"] * math.log2(max(2, kind.value("WIDTH")))
        )

    def setup_ns(self, kind, fo4_ns):
        macro = self.macro(kind)
        return macro.setup_ns if macro else fo4_ns * self.data["setup_fo4"]

    def energy_pj(self, kind):
        """Of one access, at the reference node."""
        return kind.value("WIDTH") * self.data["energy_fj_a_bit"] / 1000

    def liberty(self, kinds, fo4_ns, path):
        """Writes the timing of all memories among `kinds` as a Liberty file, in the units ns and pF."""
        inverter = self.library.cells[self.library.inverter]
        pin_pf = 2 * inverter.inputs()[0].capacitance * self.library.to_pf
        slope = fo4_ns / (8 * inverter.inputs()[0].capacitance * self.library.to_pf)  # ns a pF, of a strong driver
        widths = sorted({w for k in kinds for _, w in k.ports.values() if w > 1})
        voltage = self.library.group.attributes.get("nom_voltage", "1.0")
        with open(path, "w", encoding="utf-8") as file:
            file.write(
                f"""library(raypool_memories) {{
  delay_model : table_lookup; time_unit : "1ns"; voltage_unit : "1V"; current_unit : "1uA"; leakage_power_unit : "1nW";
  pulling_resistance_unit : "1kohm"; capacitive_load_unit (1,pf); nom_process : 1; nom_temperature : 25;
  nom_voltage : {voltage};
  operating_conditions(typical) {{ process : 1; voltage : {voltage}; temperature : 25; }}
  default_operating_conditions : typical;
  slew_upper_threshold_pct_rise : 80; slew_lower_threshold_pct_rise : 20; slew_upper_threshold_pct_fall : 80;
  slew_lower_threshold_pct_fall : 20; input_threshold_pct_rise : 50; input_threshold_pct_fall : 50;
  output_threshold_pct_rise : 50; output_threshold_pct_fall : 50;
  lu_table_template(load) {{ variable_1 : total_output_net_capacitance; index_1 ("0, 1"); }}
"""
            )
            for width in widths:
                file.write(
                    f"  type (bus{width}) {{ base_type : array; data_type : bit; bit_width : {width}; "
                    f"bit_from : {width - 1}; bit_to : 0; downto : true; }}\n"
                )
            for kind in kinds:
                self._cell(file, kind, fo4_ns, pin_pf, slope)
            file.write("}\n")

    def _cell(self, file, kind, fo4_ns, pin_pf, slope):
        access, setup = self.access_ns(kind, fo4_ns), self.setup_ns(kind, fo4_ns)
        file.write(f"  cell({kind.name}) {{ area : {self.price(kind).nominal:.1f}; interface_timing : true;\n")
        for name, (direction, width) in kind.ports.items():
            head = f"pin({name}) {{" if width == 1 else f"bus({name}) {{ bus_type : bus{width};"
            if name == "clk_i":
                file.write(f"    {head} direction : input; clock : true; capacitance : {pin_pf:.6f}; }}\n")
            elif direction == "input":
                timing = "".join(
                    f'timing() {{ related_pin : "clk_i"; timing_type : {check}_rising; '
                    f'rise_constraint(scalar) {{ values ("{value:.4f}"); }} '
                    f'fall_constraint(scalar) {{ values ("{value:.4f}"); }} }} '
                    for check, value in (("setup", setup), ("hold", 0.0))
                )
                file.write(f"    {head} direction : input; capacitance : {pin_pf:.6f}; {timing}}}\n")
            else:
                table = f'values ("{access:.4f}, {access + slope:.4f}");'
                slew = f'values ("{fo4_ns:.4f}, {fo4_ns + slope:.4f}");'
                file.write(
                    f'    {head} direction : output; timing() {{ related_pin : "clk_i"; timing_type : rising_edge; '
                    f"timing_sense : non_unate; cell_rise(load) {{ {table} }} cell_fall(load) {{ {table} }} "
                    f"rise_transition(load) {{ {slew} }} fall_transition(load) {{ {slew} }} }} }}\n"
                )
        file.write("  }\n")
