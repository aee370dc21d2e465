/// tests/support/doctest_main.cpp: main of every test program.
// doctest's Approx allows epsilon * (scale + the larger value), with a scale of 1: between lengths in m, areas in m^2 or heats in J, far below 1, no
// check could fail. Here, where doctest is implemented, the scale's first value becomes as good as 0, so epsilon is a share of the larger
// value. It is not 0: doctest asks in this way whether a case's time limit is 0, and 0 < 0 is false.
#define m_scale(one) m_scale(1e-200)  // NOLINT(readability-identifier-naming): a name of doctest
#define DOCTEST_CONFIG_IMPLEMENT_WITH_MAIN
#include <doctest/doctest.h>
#undef m_scale

#include <cstdio>
#include <cstdlib>

#include "tests/support/skip.h"

#ifdef __SANITIZE_THREAD__
#include <tbb/global_control.h>

namespace {
// ThreadSanitizer does not know how TBB hands over work and reports about a hundred races that do not exist: no worker threads under it.
// Loops of TBB are covered by equal hashes for one and two threads.
const tbb::global_control one_thread(tbb::global_control::max_allowed_parallelism, 1);
}  // namespace
#endif

namespace {

bool a_check_failed = false;

/// Notes failures, so that a later skip cannot hide them.
struct FailureListener : doctest::IReporter {
  explicit FailureListener(const doctest::ContextOptions&) {}
  void report_query(const doctest::QueryData&) override {}
  void test_run_start() override {}
  void test_run_end(const doctest::TestRunStats&) override {}
  void test_case_start(const doctest::TestCaseData&) override {}
  void test_case_reenter(const doctest::TestCaseData&) override {}
  void test_case_end(const doctest::CurrentTestCaseStats&) override {}
  void test_case_exception(const doctest::TestCaseException&) override { a_check_failed = true; }
  void subcase_start(const doctest::SubcaseSignature&) override {}
  void subcase_end() override {}
  void log_assert(const doctest::AssertData& data) override { a_check_failed = a_check_failed || data.m_failed; }
  void log_message(const doctest::MessageData&) override {}
  void test_case_skipped(const doctest::TestCaseData&) override {}
};
REGISTER_LISTENER("failures", 1, FailureListener);

}  // namespace

void burrhole::test::skip(const std::string& reason) {
  std::fprintf(stderr, "skipped: %s\n", reason.c_str());
  std::exit(a_check_failed ? 1 : 77);
}
