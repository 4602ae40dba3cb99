// The importer taken over by its file: shell scripts in its place, that do what they should not.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <thread>

#include "server/import_process.h"
#include "tests/server/rogue.h"

namespace relight::test {
namespace {

using Clock = std::chrono::steady_clock;
using namespace std::chrono_literals;

/// Prints a header: its length of content, width and height as printf has them; no negatives.
std::string announcing(std::string_view bytes, std::string_view size)
{
    std::string script = "printf 'RELIGHT2";
    return script.append(bytes).append(size).append(R"(\0\0\0\0\0\0\0\0')");
}

const std::string bytes_24 = R"(\030\0\0\0\0\0\0\0)", size_2_by_1 = R"(\002\0\0\0\001\0\0\0)";
const std::string header = announcing(bytes_24, size_2_by_1);
const std::string texels = "head -c 24 /dev/zero";
const std::string swallow = "cat >/dev/null";

struct Outcome {
    Result<ImportedImage> result;
    Clock::duration took;
};

Outcome import_by(const std::string& script, std::size_t bytes = 1000, ImportLimits limits = {})
{
    const Rogue rogue(script);
    limits.program = rogue.path();
    Progress progress;
    const std::vector<std::byte> file(bytes);
    const Clock::time_point begin = Clock::now();
    auto result = import_exr(file, limits, progress);
    return {std::move(result), Clock::now() - begin};
}

void expect_failed(const std::string& script, std::size_t bytes = 1000)
{
    const Outcome outcome = import_by(script, bytes, {.memory = 1ULL << 26U});
    ASSERT_FALSE(outcome.result) << script;
    EXPECT_EQ(outcome.result.error().fault, Fault::ImportFailed) << script;
    EXPECT_FALSE(outcome.result.error().detail.empty()) << script;
    EXPECT_LT(outcome.took, 5s) << script;
}

TEST(ImportRogue, AnHonestOneIsBelieved)
{
    const Outcome outcome = import_by(swallow + "\n" + header + "\n" + texels);
    ASSERT_TRUE(outcome.result) << outcome.result.error().detail;
    EXPECT_EQ(outcome.result->image.width, 2);
    EXPECT_EQ(outcome.result->image.pixels, std::vector<Rgbf>(2));
    const Outcome refusal = import_by(swallow + "\necho 'truncated in row 3'; exit 2");
    ASSERT_FALSE(refusal.result);
    EXPECT_EQ(refusal.result.error().fault, Fault::Truncated);
    EXPECT_EQ(refusal.result.error().detail, "in row 3");
}

TEST(ImportRogue, CrashesAndStrangeEndsAreTheFilesFault)
{
    const std::string said = header + "\n" + texels;
    for (const char* signal : {"SEGV", "SYS", "KILL", "XCPU", "ABRT", "XFSZ"}) {
        expect_failed(std::string("kill -") + signal + " $$");
        expect_failed(said + "\nkill -" + signal + " $$");
    }
    for (const char* status : {"0", "1", "2", "70", "127"}) {
        expect_failed(std::string("exit ") + status);
        expect_failed(swallow + "\nexit " + status);
    }
    expect_failed(header + "\n" + texels + "\nexit 1");
    expect_failed(header + "\n" + texels + "\nexit 2");
    expect_failed("echo 'truncated in row 3'; exit 0");
}

TEST(ImportRogue, NonsenseIsNotBelieved)
{
    expect_failed("echo 'internal a code that no decoder has'; exit 2");
    expect_failed("printf 'truncated no line end'; exit 2");
    expect_failed("echo truncatedness; exit 2");
    expect_failed(header);                                                        // no texels
    expect_failed(header + "\nhead -c 23 /dev/zero");                             // one byte short
    expect_failed(header + "\nhead -c 25 /dev/zero");                             // one too many
    expect_failed(header + "\nprintf '\\0\\0\\300\\177'\nhead -c 20 /dev/zero");  // NaN
    expect_failed(header + "\nprintf '\\0\\0\\200\\277'\nhead -c 20 /dev/zero");  // -1
    for (const char* size :
         {R"(\0\0\0\0\001\0\0\0)", R"(\001\0\0\0\0\0\0\0)", R"(\377\377\377\377\377\377\377\377)",
          R"(\001\0\0\002\001\0\0\0)"}) {  // 2^25 + 1 texels
        expect_failed(announcing(bytes_24, size).append("; ").append(texels));
    }
    for (const char* bytes :  // not those of 2 x 1 texels
         {R"(\027\0\0\0\0\0\0\0)", R"(\031\0\0\0\0\0\0\0)", R"(\030\0\0\0\0\0\0\200)",
          R"(\0\0\0\0\0\0\0\0)"}) {
        expect_failed(announcing(bytes, size_2_by_1).append("; ").append(texels));
    }
    expect_failed(announcing(R"(\014\0\0\030\0\0\0\0)", R"(\001\0\0\002\001\0\0\0)"));  // 2^25 + 1
    const Outcome text = import_by(R"(printf 'truncated \033[31m\303\251\n'; exit 2)");
    ASSERT_FALSE(text.result);
    EXPECT_EQ(text.result.error().detail, "?[31m??");
}

TEST(ImportRogue, FloodsEndAtTheirBound)
{
    expect_failed("yes");
    expect_failed(header + "\ncat /dev/zero");
    expect_failed("yes", 50'000'000);
    expect_failed("yes >&2 & cat >/dev/null; sleep .2");  // of errors: nobody listens
}

TEST(ImportRogue, ItMaySpeakBeforeItHasHeardAll)
{
    const Outcome deaf = import_by(header + "\n" + texels, 50'000'000);
    ASSERT_TRUE(deaf.result) << deaf.result.error().detail;
    const Outcome echo = import_by("echo 'malformed_header at once'; exit 2", 50'000'000);
    ASSERT_FALSE(echo.result);
    EXPECT_EQ(echo.result.error().fault, Fault::MalformedHeader);
    // More than both directions' buffers hold at once.
    const Outcome slow = import_by(announcing(R"(\0\0\200\001\0\0\0\0)", R"(\0\010\0\0\0\004\0\0)")
                                       .append("; head -c 25165824 /dev/zero; ")
                                       .append(swallow),
                                   50'000'000);
    ASSERT_TRUE(slow.result) << slow.result.error().detail;
    EXPECT_EQ(slow.result->image.pixels.size(), 2048U * 1024U);
}

TEST(ImportRogue, HangsEndInTime)
{
    const std::string said = header + "; " + texels;
    const std::string scripts[] = {"sleep 60",
                                   "sleep 60 & " + swallow + "; wait",
                                   header + "; sleep 60",
                                   said + "; exec <&- >&-; sleep 60",
                                   "while :; do :; done",
                                   "trap '' TERM INT HUP; while :; do sleep 1; done",
                                   "while printf x; do sleep .01; done"};
    for (const std::string& script : scripts) {
        for (const std::size_t bytes : {1000U, 5'000'000U}) {
            const Outcome outcome = import_by(script, bytes, {.time = 300ms});
            ASSERT_FALSE(outcome.result) << script;
            EXPECT_EQ(outcome.result.error().fault, Fault::ImportFailed) << script;
            EXPECT_GE(outcome.took, 300ms) << script;
            EXPECT_LT(outcome.took, 3s) << script;
        }
    }
}

TEST(ImportRogue, StopsWhenTold)
{
    const Rogue rogue("sleep 60");
    Progress progress;
    std::thread stopper([&] {
        std::this_thread::sleep_for(100ms);
        progress.stop();
    });
    const std::vector<std::byte> file(1000);
    const Clock::time_point begin = Clock::now();
    const auto result = import_exr(file, {.program = rogue.path()}, progress);
    const Clock::duration took = Clock::now() - begin;
    stopper.join();
    ASSERT_FALSE(result);
    EXPECT_EQ(result.error().fault, Fault::Cancelled);
    EXPECT_LT(took, 500ms);  // 100 of them are the wait above; the rest allows for a busy machine
}

TEST(ImportRogue, InheritsNeitherFilesNorEnvironmentNorBlockedSignals)
{
    const int leaked = ::open("/dev/null", O_RDONLY);  // without O_CLOEXEC
    ASSERT_EQ(::dup2(leaked, 77), 77);
    sigset_t all, before;
    ::sigfillset(&all);
    ::pthread_sigmask(SIG_BLOCK, &all, &before);
    const Outcome outcome = import_by(
        "echo \"truncated $(ls /proc/$$/fd | tr '\\n' ' '); $(env | grep -c =) "
        "$(grep SigBlk /proc/$$/status)\"; exit 2");
    ::pthread_sigmask(SIG_SETMASK, &before, nullptr);
    ::close(77);
    ::close(leaked);
    ASSERT_FALSE(outcome.result);
    const std::string& said = outcome.result.error().detail;
    EXPECT_TRUE(said.starts_with("0 1 ")) << said;
    EXPECT_EQ(said.find(" 77 "), std::string::npos) << said;
    const std::size_t variables = said.find("; ");  // PWD, OLDPWD, SHLVL, _: the shell's own
    ASSERT_LT(variables, said.size()) << said;
    EXPECT_LE(std::stoi(said.substr(variables + 2)), 4) << said;
    EXPECT_TRUE(said.ends_with("0000000000000000")) << said;
}

TEST(ImportRogue, LeavesNothingBehind)
{
    const auto descriptors = [] {
        return std::distance(std::filesystem::directory_iterator("/proc/self/fd"), {});
    };
    const auto before = descriptors();
    import_by("sleep 60 & sleep 60", 1000, {.time = 50ms});
    import_by("exit 0");
    import_by(header + "; " + texels);
    EXPECT_EQ(descriptors(), before);
    EXPECT_EQ(::waitpid(-1, nullptr, WNOHANG), -1) << "a process was not waited for";
    EXPECT_EQ(errno, ECHILD);
}

TEST(ImportRogue, AMissingImporterIsTheServersOwnFault)
{
    Progress progress;
    const std::vector<std::byte> file(10);
    EXPECT_THROW(
        static_cast<void>(import_exr(file, {.program = "/nowhere/relight-import"}, progress)),
        std::system_error);
}

}  // namespace
}  // namespace relight::test
