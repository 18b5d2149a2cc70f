// The one main of all tests. ctest runs it once per source file, with --source-file=...
//
// doctest::Approx(x).epsilon(e) lets pass what is within e (1 + |x|): far below 1 an absolute tolerance. With
// .scale(0) it is e |x|.
#define DOCTEST_CONFIG_IMPLEMENT
#include <abrade/core/parallel.hpp>

#include <doctest/doctest.h>

#include <iostream>

namespace {

unsigned cases_chosen = 0;

struct CountCases : doctest::IReporter {
    explicit CountCases(const doctest::ContextOptions&) {}
    void report_query(const doctest::QueryData&) override {}
    void test_run_start() override {}
    void test_run_end(const doctest::TestRunStats& stats) override {
        cases_chosen = stats.numTestCasesPassingFilters;
    }
    void test_case_start(const doctest::TestCaseData&) override {}
    void test_case_reenter(const doctest::TestCaseData&) override {}
    void test_case_end(const doctest::CurrentTestCaseStats&) override {}
    void test_case_exception(const doctest::TestCaseException&) override {}
    void subcase_start(const doctest::SubcaseSignature&) override {}
    void subcase_end() override {}
    void log_assert(const doctest::AssertData&) override {}
    void log_message(const doctest::MessageData&) override {}
    void test_case_skipped(const doctest::TestCaseData&) override {}
};

}  // namespace

REGISTER_LISTENER("count_cases", 1, CountCases);

int main(int argc, char** argv) {
    abrade::detail::share_every_loop = true;  // small as our scenes are, tests of threads are to have some
    doctest::Context context(argc, argv);
    const int result = context.run();
    if (context.shouldExit()) return result;
    if (cases_chosen == 0) {  // a filter that matches nothing must not pass
        std::cerr << "error: no test case was chosen\n";
        return 1;
    }
    return result;
}
