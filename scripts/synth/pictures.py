"""Pictures of reports. Matplotlib is loaded late, as it takes a second."""


def plots():
    from plots import plot

    return plot


def area_bars(report, png):
    """Area by first-level block, logic and memory stacked."""
    rows = [b for b in report["blocks"][1:] if "/" not in b["block"]
            and b["logic_kge"] + b["memory_kge"] > 0.005 * report["area"]["total_kge"]]  # fmt: skip
    rows.sort(key=lambda b: -b["logic_kge"] - b["memory_kge"])
    plot = plots().Plot(368, plots().WIDE)
    names = [b["block"].replace("_", " ") + (f" x{b['instances']}" if b["instances"] > 1 else "") for b in rows]
    plot.bars(names, [("logic", "accent", [b["logic_kge"] for b in rows]),
                      ("memory", "ray", [b["memory_kge"] for b in rows])], stacked=True)  # fmt: skip
    plot.title(f"{report['config']}: {report['area']['total_kge']:.0f} kGE, "
               f"{report['forty_nm']['total_mm2']:.3f} mm² at 40 nm")
    plot.axes.set_ylabel("kGE")
    plots().legend(plot.axes, loc="upper right")
    plot.save(png, f"Area of {report['config']} by block")


def growth_lines(title, xlabel, rows, png):
    """rows: (x, logic kGE, memory kGE)."""
    plot = plots().Plot(274, 403)
    values = [x for x, *_ in rows]
    for words, name, mark, ys in (("all", "mem", "^", [logic + memory for _, logic, memory in rows]),
                                  ("logic", "accent", "o", [logic for _, logic, _ in rows]),
                                  ("memory", "ray", "s", [memory for *_, memory in rows])):  # fmt: skip
        plot.line(values, ys, name, mark, words)
    plot.title(title)
    plot.axes.set_xticks(values)
    plot.axes.set_xlabel(xlabel)
    plot.axes.set_ylabel("kGE")
    plot.axes.set_ylim(bottom=0)
    plots().legend(plot.axes, loc="upper left")
    plot.save(png, title)
