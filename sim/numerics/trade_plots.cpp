// The trade as gnuplot texts.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

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
set key outside top center horizontal
set xtics rotate by -25
set arrow from graph 0, first 58.9 to graph 1, first 58.9 nohead front dashtype 2 linewidth 2 linecolor "black"
set rmargin 17
set label "8-bit rounding" at graph 1.01, first 58.9 left front
{}
)plot";

constexpr const char* kPareto = R"plot(set terminal pngcairo size 1000,620 font ",13"
set output "{}"
$all << END
{}END
$front << END
{}END
set title "Arithmetic on {}: quality against size"
set xlabel "Flt and Slw ALUs, all lanes, kGE (less is better)"
set ylabel "PSNR of equal paths, {}, dB (more is better)"
set grid
set key bottom right
set xrange [{}:{}]
set offsets graph 0, graph 0, graph 0.4, graph 0.1
plot $front using 1:2 with steps linewidth 2 linecolor "#4477aa" title "not beaten in both", \
  $all using 1:2 with points pointtype 7 pointsize 1.6 linecolor "#4477aa" notitle, \
  $all using 1:2:3 with labels left rotate by 55 offset char 0.3,0.7 notitle
)plot";

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
    plots += fmt::format("{}$data using {}{} title \"{}\"", i == 0 ? "plot " : ", ", i + 2, i == 0 ? ":xtic(1)" : "", scenes[i]);
  }
  return fmt::format(kQuality, png, data, plots);
}

std::string pareto_plot(const TradeResult& result, const std::string& png) {
  struct Point {
    std::string modes;
    double kge, psnr;
  };
  std::vector<Point> points;
  for (const TradeCost& cost : result.costs) {
    if (!cost.gates) continue;
    for (const TradeRow& row : result.rows) {
      // The first scene: what a far one loses by its coordinates hides what the modes lose.
      if (row.mode.name != cost.mode.name || row.scene != result.rows.front().scene) continue;
      if (std::isfinite(row.quality.psnr_same_paths))
        points.push_back({cost.mode.name, cost.gates->total(), row.quality.psnr_same_paths});
    }
  }
  if (points.size() < 2) return "";
  std::sort(points.begin(), points.end(),
            [](const Point& a, const Point& b) { return a.kge != b.kge ? a.kge < b.kge : a.psnr > b.psnr; });
  std::string all, front;
  double best = -INFINITY;
  for (const Point& point : points) {
    const std::string line = fmt::format("{} {} \"{}\"\n", point.kge, point.psnr, point.modes);
    all += line;
    if (point.psnr > best + kSameQuality) front += line, best = point.psnr;
  }
  const double width = std::max(points.back().kge - points.front().kge, 1.0);
  return fmt::format(kPareto, png, all, front, result.configuration, result.rows.front().scene, points.front().kge - 0.06 * width,
                     points.back().kge + 0.2 * width);
}

}  // namespace raypool::numerics
