"""The table of synthesis reports."""
from .figure import Table, number

HEADS = ("configuration", "library", "kGE", "mm2 at 40 nm", "MHz", "W")


def table(reports):
    """A row for each, in their order. MHz is the clock that the library allows."""
    rows = []
    for report in reports:
        power = report.get("power")
        rows.append([
            (str(report.get("config") or ""), report["path"]),
            report["library"]["name"],
            number(report["area"]["total_kge"]),
            number(report["forty_nm"]["total_mm2"]),
            number(1000 / report["timing"]["allowed_ns"]),
            number(power["total_w"] if power else None),
        ])  # fmt: skip
    return Table("What was synthesised, a unit or a chip each", HEADS, rows)
