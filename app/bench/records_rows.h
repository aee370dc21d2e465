/// app/bench/records_rows.h: rows of the area contact about surface records.
#pragma once

#include "app/bench/bench.h"

namespace burrhole {

/// An update after a bite against a rebuild of the window, and what each costs.
void bench_records(Bench& bench);

}  // namespace burrhole
