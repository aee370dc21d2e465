/// tests/support/doctest_main.cpp: main of every test program.
#define DOCTEST_CONFIG_IMPLEMENT_WITH_MAIN
#include <doctest/doctest.h>

#ifdef __SANITIZE_THREAD__
#include <tbb/global_control.h>

namespace {
// ThreadSanitizer does not know TBB's hand-overs and reports about a hundred races that are none: no worker threads under it. Loops of TBB
// are covered by equal hashes for one and two threads.
const tbb::global_control one_thread(tbb::global_control::max_allowed_parallelism, 1);
}  // namespace
#endif
