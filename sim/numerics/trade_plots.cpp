// The trade as gnuplot texts.
#include <fmt/format.h>
#include <fmt/ranges.h>

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
set key outside top center horizontal
set xtics rotate by -25
set arrow from graph 0, first 58.9 to graph 1, first 58.9 nohead front dashtype 2 linewidth 2 linecolor "black"
set rmargin 17
set label "8-bit rounding" at graph 1.01, first 58.9 left front
{}
)plot";

constexpr const char* kPareto = R"plot(set terminal pngcairo size {},620 font ",13"
set output "{}"
set multiplot layout 1,{} title "Arithmetic on {}: quality against cost"
set ylabel "PSNR of equal paths, {}, dB (more is better)"
set grid
set key bottom right
{}unset multiplot
)plot";

constexpr const char* kPanel = R"plot($all << END
{0}END
$front << END
{1}END
set xlabel "{2} (less is better)"
set xrange [{3}:{4}]
set yrange [{5}:{6}]
plot $front using 1:2 with steps linewidth 2 linecolor "#4477aa" title "not beaten in both", \
  $all using 1:2 with points pointtype 7 pointsize 1.4 linecolor "#4477aa" notitle, \
  $all using 1:($4 > 0 ? 1/0 : $2):3 with labels left rotate by 60 offset char 0.2,0.6 font ",9" notitle, \
  $all using 1:($4 > 0 ? $2 : 1/0):3 with labels left rotate by -60 offset char 0.2,-0.6 font ",9" notitle
)plot";

/// A place in a panel, with the modes that are there.
struct Point {
  double cost, psnr;
  std::vector<ArithmeticMode> modes;
  bool below = false;  ///< where its label stands
};

/// "ieee flush, exact newton2": short where the modes are all combinations of some subnormal modes and slow units.
std::string label(const std::vector<ArithmeticMode>& modes) {
  std::vector<std::string> subnormals, units, ends;
  std::string names;
  const auto note = [](std::vector<std::string>& list, const std::string& text) {
    if (std::find(list.begin(), list.end(), text) == list.end()) list.push_back(text);
  };
  for (const ArithmeticMode& mode : modes) {
    const size_t first = mode.name.find('-'), second = mode.name.find('-', first + 1);
    note(subnormals, mode.name.substr(0, first));
    note(units, mode.name.substr(first + 1, second - first - 1));
    note(ends, second == std::string::npos ? "" : " fma");
    names += (names.empty() ? "" : ", ") + mode.name;
  }
  if (modes.size() == 1 || ends.size() != 1 || subnormals.size() * units.size() != modes.size()) return names;
  return fmt::format("{}, {}{}", fmt::join(subnormals, " "), fmt::join(units, " "), ends.front());
}

/// Above the point, or below it where the label of a neighbour is in the way: of points of one quality closer than `near`
/// every other one, and what lies under another point.
void place_labels(std::vector<Point>& points, double near) {
  for (Point& point : points) {
    for (const Point& other : points) {
      if (std::fabs(point.cost - other.cost) > near) continue;
      if (std::fabs(point.psnr - other.psnr) >= kSameQuality) {
        point.below |= other.psnr > point.psnr && other.psnr < point.psnr + 10;
      } else if (other.cost < point.cost) {
        point.below = !other.below;
      }
    }
  }
}

std::string panel(const TradeResult& result, const std::string& axis,
                  const std::function<std::optional<double>(const TradeCost&)>& cost_of) {
  std::vector<Point> points;
  size_t modes = 0;
  for (const TradeCost& cost : result.costs) {
    const std::optional<double> known = cost_of(cost);
    for (const TradeRow& row : result.rows) {
      // The first scene: what a far one loses by its coordinates hides what the modes lose.
      if (!known || row.mode.name != cost.mode.name || row.scene != result.rows.front().scene) continue;
      const double psnr = row.quality.psnr_same_paths;
      if (!std::isfinite(psnr)) continue;
      ++modes;
      const auto same = std::find_if(points.begin(), points.end(), [&](const Point& p) {
        return std::fabs(p.psnr - psnr) < kSameQuality && std::fabs(p.cost - *known) < 1e-3 * *known;
      });
      if (same == points.end()) {
        points.push_back({*known, psnr, {cost.mode}});
      } else {
        same->modes.push_back(cost.mode);
      }
    }
  }
  if (modes < 2) return "";
  std::sort(points.begin(), points.end(),
            [](const Point& a, const Point& b) { return a.cost != b.cost ? a.cost < b.cost : a.psnr > b.psnr; });
  const double width = std::max(points.back().cost - points.front().cost, 0.02 * points.back().cost);
  place_labels(points, 0.1 * width);
  std::string all, front;
  double best = -INFINITY, lowest = INFINITY;
  for (const Point& point : points) {
    const std::string line = fmt::format("{} {} \"{}\" {:d}\n", point.cost, point.psnr, label(point.modes), point.below);
    all += line;
    lowest = std::min(lowest, point.psnr);
    if (point.psnr > best + kSameQuality) front += line, best = point.psnr;
  }
  const double height = std::max(best - lowest, 1.0);
  return fmt::format(kPanel, all, front, axis, points.front().cost - 0.06 * width, points.back().cost + 0.3 * width,
                     lowest - 0.5 * height, best + 0.75 * height);
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
    plots += fmt::format("{}$data using {}{} title \"{}\"", i == 0 ? "plot " : ", ", i + 2, i == 0 ? ":xtic(1)" : "", scenes[i]);
  }
  return fmt::format(kQuality, png, data, plots);
}

std::string pareto_plot(const TradeResult& result, const std::string& png) {
  std::string panels;
  int count = 0;
  const auto add = [&](const std::string& text) { panels += text, count += !text.empty(); };
  add(panel(result, "one lane of Flt and one of Slw, kGE",
            [](const TradeCost& cost) { return cost.gates ? std::optional<double>(cost.gates->total()) : std::nullopt; }));
  add(panel(result, "cycles a ray", [](const TradeCost& cost) {
    return cost.timing ? std::optional<double>(cost.timing->cycles_per_ray) : std::nullopt;
  }));
  if (count == 0) return "";
  return fmt::format(kPareto, 750 * count, png, count, result.configuration, result.rows.front().scene, panels);
}

}  // namespace raypool::numerics
