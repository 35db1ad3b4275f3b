// Hardware that is only what a frame requires: the search, over whatever measures a machine.
#pragma once

#include <cstdint>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "config/configuration.hpp"

namespace raypool::fit {

/// A field of the configuration with a value that is less hardware than the machine has.
struct Cut {
  std::string field;  ///< "data_cache.bytes"
  nlohmann::ordered_json value;
  std::string why;  ///< that much may suffice: what is known of scene and kernels
};

/// One thing that there may be less of: of the machine as it is by then, what may be tried, the least first.
using Part = std::function<std::vector<Cut>(const Configuration&)>;

/// Cycles of the frame on a machine; none if it cannot draw it. `what` is in a few words what is tried.
using Measure = std::function<std::optional<uint64_t>(const Configuration&, const std::string& what)>;

struct Change {
  Cut cut;
  nlohmann::ordered_json from;
  std::optional<uint64_t> cycles;  ///< of the base with this alone; none if it cannot draw the frame so
};

struct Fit {
  Configuration base, fitted;
  uint64_t base_cycles = 0, most_cycles = 0, cycles = 0;  ///< of the base, allowed, of the fitted one
  std::vector<Change> changes;                            ///< in the order of the parts
};

/// Part after part, in the order given: of its cuts the first with which the frame takes at most (1 + slower) times
/// `base_cycles`, both on the base with this alone, if that can draw it, and on the machine with all that was cut
/// before. So the whole keeps to it, an earlier part may leave less to a later one, and what one part gains no other
/// spends. Every machine is measured once.
Fit fit(const Configuration& base, uint64_t base_cycles, const std::vector<Part>& parts, double slower,
        const Measure& measure);

/// A configuration with one field changed. Throws InputError when it is none then.
Configuration with(const Configuration& configuration, const Cut& cut);

/// The text of the shortest configuration file of it: its name, and what differs from its defaults.
std::string shortest_file(const Configuration& configuration);

}  // namespace raypool::fit
