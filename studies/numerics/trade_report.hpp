// The trade in words and numbers.
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

}  // namespace raypool::numerics
