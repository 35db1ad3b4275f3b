// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// Fields of a machine that nothing looks at, as another field is what it is: those of a traverser that it has not, for
// example. They change its name, and nothing that a run shows.
#pragma once

#include <string>
#include <vector>

#include "config/configuration.hpp"

namespace raypool {

struct UnusedField {
  std::string path;    ///< "chip.hardware_traverser.rays"
  std::string reason;  ///< "chip.traverser is static, which has no machine inside"
  std::string remedy;  ///< what to do to have it looked at
};

/// In the order of the tables, whatever values they have.
std::vector<UnusedField> unused_fields(const Configuration& configuration);

/// Throws InputError, one sentence, if `set` of the configuration names one of them.
void refuse_unused_settings(const Configuration& configuration);

/// The same for runs of compute programs: of the chip they have the memory alone.
void refuse_settings_of_frames(const Configuration& configuration);

/// The sentence of those that the file sets to something else than machines have without it; of a configuration that
/// was loaded. Empty: there are none.
std::string unused_in_file(const Configuration& configuration);

}  // namespace raypool
