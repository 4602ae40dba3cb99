#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>
#include <iostream>

#include "server/check_report.h"

namespace relight {
namespace {

int run(int argc, char** argv)
{
    CLI::App app("relight: the light of relightd on the command line", "relight");
    app.set_version_flag("--version", "relight " RELIGHT_VERSION);
    app.require_subcommand(1);
    CLI::App* check = app.add_subcommand(
        "check", "computes every closed-form case and compares: exit status 0 if all pass, else 1");
    bool json = false;
    unsigned threads = 0;
    check->add_flag("--json", json, "the answer of GET /v1/check instead of a table");
    check->add_option("--threads", threads, "0: one a core")->check(CLI::Range(0, 1024));
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        return app.exit(error);
    }
    Progress progress;
    const auto cases = run_checks(threads, progress);
    std::cout << (json ? check_json(cases, RELIGHT_VERSION) + '\n'
                       : check_table(cases, RELIGHT_VERSION, ::isatty(STDOUT_FILENO) == 1))
              << std::flush;
    return failures(cases) == 0 && std::cout ? 0 : 1;
}

}  // namespace
}  // namespace relight

int main(int argc, char** argv)
{
    try {
        return relight::run(argc, argv);
    } catch (const std::exception& error) {
        std::fprintf(stderr, "relight: %s\n", error.what());
        return 2;
    }
}
