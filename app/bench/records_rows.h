/// app/bench/records_rows.h: rows of surface records in the area contact.
#pragma once

#include "app/bench/bench.h"

namespace burrhole {

/// Times an update of the records after a cut; the baseline rebuilds the records of the window.
void bench_records(Bench& bench);

}  // namespace burrhole
