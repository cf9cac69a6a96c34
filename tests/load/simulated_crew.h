// The process of the simulated workers.
#pragma once

#include <string>

#include "tests/load/load_board.h"

namespace penumbra {

/// Until the scheduler at the address has sent all of them away, or is gone.
void run_simulated_crew(LoadBoard& board, const std::string& address, const std::string& key);

}  // namespace penumbra
