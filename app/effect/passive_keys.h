/// app/effect/passive_keys.h: the keys of an effect's table that limit the energy of its force on the hand (haptics/servo/passive_force.h).
#pragma once

#include <string>

#include "core/config/toml.h"
#include "haptics/servo/passive_force.h"

namespace burrhole {

/// Reads allowance_mJ and acceleration_m_per_s2. @param what gives the force, as in "the dura".
void read_passive_limit(TableReader& table, const std::string& what, PassiveForceConfig& out);

}  // namespace burrhole
