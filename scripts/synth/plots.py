"""Pictures of reports, with gnuplot."""
import os

from .errors import need, run

HEAD = """set terminal pngcairo size {width},{height} font 'Sans,10' background 'white'
set output '{png}'
set style line 1 lc rgb '#4472a8'
set style line 2 lc rgb '#c9824a'
set style line 3 lc rgb '#5a9367'
set border 3 lc rgb '#666666'
set tics nomirror
set grid ytics lc rgb '#dddddd'
"""


def draw(script, folder, name):
    path = os.path.join(folder, name + ".gp")
    with open(path, "w", encoding="utf-8") as file:
        file.write(script)
    run([need("gnuplot", "gnuplot-nox"), path], os.path.join(folder, name + ".log"))


def area_bars(report, folder, png):
    """Area by first-level block, logic and memory stacked."""
    rows = [
        b
        for b in report["blocks"][1:]
        if "/" not in b["block"]
        and b["logic_kge"] + b["memory_kge"] > 0.005 * report["area"]["total_kge"]
    ]
    rows.sort(key=lambda b: -b["logic_kge"] - b["memory_kge"])
    data = "\n".join(
        f"\"{b['block'].replace('_', ' ')}{' x' + str(b['instances']) if b['instances'] > 1 else ''}\" "
        f"{b['logic_kge']} {b['memory_kge']}"
        for b in rows
    )
    draw(
        HEAD.format(width=900, height=460, png=png)
        + f"""$data << end
{data}
end
set title "{report['config']}: {report['area']['total_kge']:.0f} kGE, \
{report['forty_nm']['total_mm2']:.3f} mm^2 at 40 nm"
set ylabel "kGE"
set yrange [0:*]
set style data histograms
set style histogram rowstacked
set style fill solid 0.9 border rgb '#ffffff'
set boxwidth 0.75
set xtics rotate by -35
set key top right
plot $data using 2:xtic(1) ls 1 title "logic", '' using 3 ls 2 title "memory"
""",
        folder,
        "area",
    )


def growth_lines(title, xlabel, rows, folder, png):
    """rows: (x, logic kGE, memory kGE)."""
    data = "\n".join(f"{x} {logic} {memory}" for x, logic, memory in rows)
    draw(
        HEAD.format(width=560, height=380, png=png)
        + f"""$data << end
{data}
end
set title "{title}"
set xlabel "{xlabel}"
set ylabel "kGE"
set yrange [0:*]
set key top left reverse Left
set xtics ({', '.join(str(r[0]) for r in rows)})
plot $data using 1:($2+$3) with linespoints ls 3 pt 7 title "all", \\
     '' using 1:2 with linespoints ls 1 pt 7 title "logic", \\
     '' using 1:3 with linespoints ls 2 pt 7 title "memory"
""",
        folder,
        os.path.splitext(os.path.basename(png))[0],
    )
