// The trade as gnuplot texts.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>

#include "numerics/trade_report.hpp"

namespace raypool::numerics {
namespace {

/// A bar's height for pictures that are equal.
constexpr double kEqual = 160;
/// Decibels within which two modes are equally good.
constexpr double kSameQuality = 0.05;

// The dashed line is the noise of rounding linear values to 8 bits, 10 log10(12 * 255^2).
constexpr const char* kQuality = R"plot(set terminal pngcairo size 1100,600 font ",13"
set output "{}"
$data << END
{}END
set title "Error of the colours alone: pixels whose rays all hit what they should"
set ylabel "PSNR before quantisation, dB (more is better)"
set yrange [0:*]
set style data histograms
set style histogram clustered gap 1
set style fill solid 0.8 border -1
set boxwidth 0.9
set grid ytics
set key outside top center horizontal samplen 2 font ",12"
set xtics rotate by -25
set arrow from graph 0, first 58.9 to graph 1, first 58.9 nohead front dashtype 2 linewidth 2 linecolor "black"
set rmargin 17
set label "8-bit rounding" at graph 1.01, first 58.9 left front
{}
)plot";

constexpr const char* kPareto = R"plot(set terminal pngcairo size {},640 font ",13"
set output "{}"
set multiplot layout 1,{} title "Arithmetic on {}: quality against cost; a line joins the modes that none beats in both"
set ylabel "PSNR of equal paths, {}, dB (more is better)"
set grid
set key below vertical maxrows 4 reverse Left samplen 1 width -1 spacing 1.3 font ",10"
set bmargin 9
{}unset multiplot
)plot";

constexpr const char* kPanel = R"plot($front << END
{0}END
$all << END
{7}END
set xlabel "{1} (less is better)"
set xrange [{2}:{3}]
set yrange [{4}:{5}]
plot $front using 1:2 with steps linewidth 2 linecolor "#999999" notitle{6}
)plot";

/// A mode's place in a panel.
struct Point {
  double cost, psnr;
  const ArithmeticMode* mode;
};

/// How a mode is drawn: colour and size by slow unit, the better the larger, so that several at one place show as
/// rings; filled with subnormals, open without; a triangle with a fused multiply-add.
std::string style(const ArithmeticMode& mode) {
  static constexpr const char* kColors[] = {"#4477aa", "#66aa55", "#ddaa33", "#bb5566"};
  const bool flush = mode.mode.subnormals != Subnormals::Ieee;
  const size_t unit = to_underlying(mode.mode.slow_unit);
  const int shape = (mode.mode.fused ? 9 : 7) - (flush ? 1 : 0);
  return fmt::format("pointtype {} pointsize {:.1f} linewidth 2 linecolor \"{}\"", shape,
                     (flush ? 3.0 : 2.0) - 0.35 * unit, kColors[unit]);
}

std::string panel(const TradeResult& result, const std::string& axis,
                  const std::function<std::optional<double>(const TradeCost&)>& cost_of) {
  std::vector<Point> points;
  for (const TradeCost& cost : result.costs) {
    const std::optional<double> known = cost_of(cost);
    for (const TradeRow& row : result.rows) {
      // The first scene: what a far one loses by its coordinates hides what the modes lose.
      if (!known || row.mode.name != cost.mode.name || row.scene != result.rows.front().scene) continue;
      if (std::isfinite(row.quality.psnr_same_paths))
        points.push_back({*known, row.quality.psnr_same_paths, &cost.mode});
    }
  }
  if (points.size() < 2) return "";
  std::string all, plots;
  for (size_t i = 0; i < points.size(); ++i) {
    all += fmt::format("{} {}\n", points[i].cost, points[i].psnr);
    plots += fmt::format(", \\\n  $all every ::{0}::{0} using 1:2 with points {1} title \"{2}\"", i,
                         style(*points[i].mode), points[i].mode->name);
  }
  std::sort(points.begin(), points.end(),
            [](const Point& a, const Point& b) { return a.cost != b.cost ? a.cost < b.cost : a.psnr > b.psnr; });
  std::string front;
  double best = -INFINITY, lowest = INFINITY;
  for (const Point& point : points) {
    lowest = std::min(lowest, point.psnr);
    if (point.psnr <= best + kSameQuality) continue;
    front += fmt::format("{} {}\n", point.cost, point.psnr);
    best = point.psnr;
  }
  const double width = std::max(points.back().cost - points.front().cost, 0.02 * points.back().cost);
  const double height = std::max(best - lowest, 1.0);
  return fmt::format(kPanel, front, axis, points.front().cost - 0.08 * width, points.back().cost + 0.08 * width,
                     lowest - 0.12 * height, best + 0.12 * height, plots, all);
}

}  // namespace

std::string quality_plot(const TradeResult& result, const std::string& png) {
  std::vector<std::string> scenes;
  for (const TradeRow& row : result.rows) {
    if (scenes.empty() || scenes.back() != row.scene) scenes.push_back(row.scene);
  }
  std::string data, plots;
  for (const TradeCost& cost : result.costs) {
    data += '"' + cost.mode.name + '"';
    for (const TradeRow& row : result.rows) {
      if (row.mode.name != cost.mode.name) continue;
      data += fmt::format(" {}", std::isfinite(row.quality.psnr_same_paths) ? row.quality.psnr_same_paths : kEqual);
    }
    data += '\n';
  }
  for (size_t i = 0; i < scenes.size(); ++i) {
    plots += fmt::format("{}$data using {}{} title \"{}\"", i == 0 ? "plot " : ", ", i + 2, i == 0 ? ":xtic(1)" : "",
                         scenes[i]);
  }
  return fmt::format(kQuality, png, data, plots);
}

std::string pareto_plot(const TradeResult& result, const std::string& png) {
  std::string panels;
  int count = 0;
  const auto add = [&](const std::string& text) { panels += text, count += !text.empty(); };
  add(panel(result, "one lane of Flt and one of Slw, kGE", [](const TradeCost& cost) {
    return cost.gates ? std::optional<double>(cost.gates->total()) : std::nullopt;
  }));
  add(panel(result, "cycles a ray", [](const TradeCost& cost) {
    return cost.timing ? std::optional<double>(cost.timing->cycles_per_ray) : std::nullopt;
  }));
  if (count == 0) return "";
  return fmt::format(kPareto, 750 * count, png, count, result.configuration, result.rows.front().scene, panels);
}

}  // namespace raypool::numerics
