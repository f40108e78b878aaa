// The deputy's state and orders as messages of the procman_lcm dialect.
#pragma once

#include "procman/deputy/deputy_state.h"
#include "procman/deputy/proc_table.h"

#include <procman_lcm/deputy_info_t.hpp>
#include <procman_lcm/orders_t.hpp>

#include <map>
#include <string>

namespace waymark {

// What a command uses, with its descendants.
struct CommandUse {
  double cpu_share = 0.0;  // Of the whole machine, 0 to 1.
  std::int64_t virtual_bytes = 0;
  std::int64_t resident_bytes = 0;
};

[[nodiscard]] DeputyOrders ToOrders(const procman_lcm::orders_t& message);
[[nodiscard]] procman_lcm::orders_t FromOrders(const DeputyOrders& orders);

[[nodiscard]] procman_lcm::deputy_info_t ToInfo(
    const std::string& deputy_id,
    const std::map<std::string, CommandState>& commands,
    const std::map<std::string, CommandUse>& uses,
    const MachineMemory& memory,
    double cpu_load,
    Time utime);

}  // namespace waymark
