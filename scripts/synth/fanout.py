"""Buffers the nets that ABC cannot see whole: those that cross a block's border, and those that a flip-flop drives."""
from collections import defaultdict


class Sinks:
    """What hangs on the nets of one module."""

    def __init__(self, netlist, module, loads):
        library = netlist.library
        self.of = defaultdict(list)  # net -> [(pF, place)]
        self.flop_driven, self.block_driven, self.crossing, self.clocks = set(), set(), set(), set()
        for gate, (cell_name, pins) in module.gates.items():
            cell = library.cells[cell_name]
            for pin, net in pins.items():
                if isinstance(net, str):
                    continue
                if cell.pins[pin].direction == "output":
                    if cell.kind == "flop":
                        self.flop_driven.add(net)
                elif cell.pins[pin].clock:
                    self.clocks.add(net)
                else:
                    self.of[net].append((library.pin_pf(cell_name, pin), ("gate", gate, pin)))
        for block, (identity, ports) in module.blocks.items():
            child = netlist.kinds[identity]
            for port, nets in ports.items():
                output = child.ports[port][0] == "output"
                for i, net in enumerate(nets):
                    if isinstance(net, str):
                        continue
                    if output:
                        self.block_driven.add(net)
                    elif port == "clk_i":
                        self.clocks.add(net)
                    else:
                        self.crossing.add(net)
                        self.of[net].append((loads[identity].get((port, i), 0.0), ("block", block, port, i)))


def move(module, place, net):
    """Connects one sink to another net."""
    if place[0] == "gate":
        module.gates[place[1]][1][place[2]] = net
    elif place[0] == "block":
        module.blocks[place[1]][1][place[2]][place[3]] = net


def buffer_tree(module, library, sinks, net):
    """Puts buffers between a net and its sinks, layer by layer, until it sees little enough.
    Returns how many, and what it sees.
    """
    cell = library.cells[library.driver]
    entry, output = cell.inputs()[0].name, cell.outputs()[0].name
    entry_pf = library.pin_pf(library.driver, entry)
    added = 0
    while sum(pf for pf, _ in sinks) > library.loads_pf["direct"] and len(sinks) > 1:
        clusters, current, load = [], [], 0.0
        for sink in sorted(sinks, key=lambda s: str(s[1])):
            if current and load + sink[0] > library.loads_pf["cluster"]:
                clusters.append(current)
                current, load = [], 0.0
            current.append(sink)
            load += sink[0]
        clusters.append(current)
        above = []
        for cluster in clusters:
            branch = module.fresh("fan")
            label = f"fan_{branch}_buf"
            module.gates[label] = (library.driver, {entry: net, output: branch})
            for _, place in cluster:
                move(module, place, branch)
            above.append((entry_pf, ("gate", label, entry)))
            added += 1
        if len(above) >= len(sinks):
            sinks = above
            break
        sinks = above
    return added, sum(pf for pf, _ in sinks)


def repair(netlist):
    """Limits the load of nets in all modules, children first. Returns the number of buffers added to each, by name."""
    library = netlist.library
    inverter = library.cells[library.inverter].inputs()[0].name
    memory_pin = 2 * library.pin_pf(library.inverter, inverter)
    loads = {
        i: {(p, b): memory_pin for p, (_, width) in k.ports.items() for b in range(width)}
        for i, k in netlist.kinds.items()
        if i not in netlist.modules
    }
    added = {}

    def visit(identity):
        if identity in loads:
            return
        module = netlist.modules[identity]
        for child, _ in module.blocks.values():
            visit(child)
        sinks = Sinks(netlist, module, loads)
        inputs = {
            net: (name, i)
            for name, direction, nets in module.ports
            if direction == "input"
            for i, net in enumerate(nets)
        }
        seen, count = {}, 0
        for net in list(sinks.of):
            hanging = sinks.of[net]
            seen[net] = sum(pf for pf, _ in hanging)
            if net in sinks.clocks:
                continue
            if net in inputs or net in sinks.flop_driven or net in sinks.block_driven or net in sinks.crossing:
                more, seen[net] = buffer_tree(module, library, hanging, net)
                count += more
        loads[identity] = {place: seen.get(net, 0.0) for net, place in inputs.items()}
        added[module.name] = count

    visit(netlist.top)
    return added
