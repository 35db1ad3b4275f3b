// The trade in words, numbers and pictures.
#pragma once

#include <string>
#include <vector>

#include "numerics/offset_study.hpp"
#include "numerics/trade.hpp"
#include "numerics/watertight.hpp"

namespace raypool::numerics {

/// One line a mode and scene; what is not known is "-".
std::string trade_table(const TradeResult& result);
/// One line a scene and rule.
std::string offset_table(const std::vector<OffsetScene>& scenes, const std::vector<OffsetRule>& rules,
                         const std::vector<std::vector<OffsetCounts>>& counts);
std::string seam_table(const std::vector<WatertightMesh>& meshes, const std::vector<WatertightCounts>& counts);

/// All of it as JSON; infinite decibels and unknown costs are null.
std::string to_json(const TradeResult& result, const std::vector<WatertightMesh>& meshes,
                    const std::vector<WatertightCounts>& seams, const std::vector<OffsetScene>& scenes,
                    const std::vector<OffsetRule>& rules, const std::vector<std::vector<OffsetCounts>>& offsets);

/// gnuplot text that draws the quality of each mode, one group of bars a scene, into `png`.
std::string quality_plot(const TradeResult& result, const std::string& png);
/// gnuplot text that draws quality against gates, and against cycles, into `png`, with the modes that no
/// other mode beats in both joined by a line; what is known of fewer than two modes is left out, and the
/// text is empty when nothing remains.
std::string pareto_plot(const TradeResult& result, const std::string& png);

}  // namespace raypool::numerics
