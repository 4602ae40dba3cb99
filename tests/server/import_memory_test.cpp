// What the server and the importer share: memory that nobody can shrink, or change once it is
// looked at; and how much of it is shared at once.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <string>
#include <thread>

#include "server/import_process.h"
#include "server/shared_memory.h"
#include "tests/server/rogue.h"

namespace relight::test {
namespace {

using Clock = std::chrono::steady_clock;
using namespace std::chrono_literals;

std::span<const std::byte> bytes_of(std::string_view text)
{
    return std::as_bytes(std::span(text));
}

std::string text_of(std::span<const std::byte> bytes)
{
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

/// A copy of the descriptor, as another process would have one.
class Copy {
  public:
    explicit Copy(const SharedMemory& memory) : fd_(::dup(memory.descriptor())) {}
    ~Copy() { ::close(fd_); }
    Copy(const Copy&) = delete;
    Copy& operator=(const Copy&) = delete;
    int fd() const { return fd_; }

  private:
    int fd_;
};

TEST(SharedMemory, HasItsLengthForGood)
{
    const SharedMemory memory(10'000);
    const Copy copy(memory);
    for (const off_t length : {0, 1, 9'999, 10'001, 1 << 20}) {
        EXPECT_NE(::ftruncate(copy.fd(), length), 0) << length;
    }
    EXPECT_EQ(::pwrite(copy.fd(), "x", 1, 9'999), 1);
    EXPECT_EQ(::pwrite(copy.fd(), "x", 1, 10'000), -1) << "beyond the end";
    const std::string name = "/proc/self/fd/" + std::to_string(copy.fd());
    EXPECT_EQ(::open(name.c_str(), O_WRONLY | O_TRUNC), -1) << "opened anew";
}

TEST(SharedMemory, SaysHowFarACopyHasWritten)
{
    SharedMemory memory(100);
    const Copy copy(memory);
    EXPECT_EQ(memory.written(), 0U);
    EXPECT_EQ(::write(copy.fd(), "abc", 3), 3);
    EXPECT_EQ(::write(copy.fd(), "de", 2), 2);
    EXPECT_EQ(memory.written(), 5U);
    ASSERT_TRUE(memory.seal());
    EXPECT_EQ(text_of(memory.map(5)), "abcde");
}

void expect_no_change(const SharedMemory& memory, const Copy& copy)
{
    EXPECT_EQ(::write(copy.fd(), "x", 1), -1);
    EXPECT_EQ(::pwrite(copy.fd(), "x", 1, 0), -1);
    EXPECT_NE(::ftruncate(copy.fd(), 0), 0);
    EXPECT_EQ(::mmap(nullptr, 1, PROT_WRITE, MAP_SHARED, copy.fd(), 0), MAP_FAILED);
    EXPECT_NE(::fallocate(copy.fd(), FALLOC_FL_PUNCH_HOLE | FALLOC_FL_KEEP_SIZE, 0,
                          static_cast<off_t>(memory.size())),
              0);
}

TEST(SharedMemory, CannotBeChangedOnceSealed)
{
    SharedMemory memory(100);
    const Copy copy(memory);
    EXPECT_EQ(::write(copy.fd(), "abc", 3), 3);
    ASSERT_TRUE(memory.seal());
    expect_no_change(memory, copy);
    EXPECT_EQ(text_of(memory.map(3)), "abc");

    SharedMemory filled(bytes_of("a file of a client's"));
    const Copy other(filled);
    expect_no_change(filled, other);
    EXPECT_EQ(filled.written(), 0U) << "its reader begins at the beginning";
    EXPECT_EQ(text_of(filled.map(filled.size())), "a file of a client's");
}

TEST(SharedMemory, IsNotSealedWhileSomebodyMayWriteIt)
{
    SharedMemory memory(4096);
    const Copy copy(memory);
    void* const mapped = ::mmap(nullptr, 4096, PROT_READ | PROT_WRITE, MAP_SHARED, copy.fd(), 0);
    ASSERT_NE(mapped, MAP_FAILED);
    EXPECT_FALSE(memory.seal());
    ::munmap(mapped, 4096);
    EXPECT_TRUE(memory.seal());

    SharedMemory taken(4096);
    const Copy thief(taken);
    ASSERT_EQ(::fcntl(thief.fd(), F_ADD_SEALS, F_SEAL_SEAL), 0);
    EXPECT_FALSE(taken.seal());
}

const std::string answer =  // 2 x 1 texels, black
    R"(printf 'RELIGHT2\030\0\0\0\0\0\0\0\002\0\0\0\001\0\0\0\0\0\0\0\0\0\0\0'; head -c 24 /dev/zero)";

Result<ImportedImage> import_by(const Rogue& rogue, Progress& progress)
{
    const std::vector<std::byte> file(1000);
    return import_exr(file, {.program = rogue.path(), .memory = 1ULL << 26U}, progress);
}

Result<ImportedImage> import_by(const std::string& script)
{
    Progress progress;
    return import_by(Rogue(script), progress);
}

TEST(ImportMemory, CannotBeShrunkByTheImporter)
{
    for (const char* change :
         {"truncate -s 0 /dev/stdout", "truncate -s 40 /dev/stdout", "truncate -s +1 /dev/stdout",
          "truncate -s 0 /dev/stdin", "printf x >>/dev/stdin"}) {
        const auto image = import_by(answer + "; if " + change + "; then exit 1; fi; exit 0");
        ASSERT_TRUE(image) << change << ": " << image.error().detail;
        EXPECT_EQ(image->image.pixels, std::vector<Rgbf>(2)) << change;
    }
}

TEST(ImportMemory, IsNotBelievedIfItsSealsAreTaken)
{
    const auto image = import_by(answer + "; exec python3 -c '" +
                                 "import fcntl; fcntl.fcntl(1, 1033, 1)'");  // F_ADD_SEALS, SEAL
    ASSERT_FALSE(image);
    EXPECT_EQ(image.error().fault, Fault::ImportFailed);
}

TEST(ImportMemory, OutlivesWhatTheImporterLeftBehind)
{
    // Another session is no part of the process group: it is not killed, and holds the file.
    const auto mapped = import_by(R"(exec python3 -c '
import mmap, os, time
m = mmap.mmap(1, 4096)
if os.fork() == 0:
    os.setsid()
    time.sleep(2)
    os._exit(0)
time.sleep(.2)
m[:32] = b"RELIGHT2" + bytes([24] + 7 * [0] + [2, 0, 0, 0, 1] + 11 * [0])
os.lseek(1, 56, 0)
')");
    ASSERT_FALSE(mapped) << "it is mapped for writing still";
    EXPECT_EQ(mapped.error().fault, Fault::ImportFailed);
    const auto late = import_by("setsid sh -c 'sleep .2; while printf x; do :; done' & " + answer);
    ASSERT_TRUE(late) << late.error().detail;
    EXPECT_EQ(late->image.pixels, std::vector<Rgbf>(2));
}

TEST(ImportMemory, HolesAndSoughtPlacesAreNotBelieved)
{
    for (const char* where : {"56, 0", "2 ** 40, 0", "-1, 1", "0, 0"}) {
        const auto image =
            import_by(answer + "; exec python3 -c 'import os; os.lseek(1, " + where + ")'");
        EXPECT_EQ(image.has_value(), std::string(where) == "56, 0") << where;
    }
}

/// A directory, gone with this object.
class Directory {
  public:
    Directory()
    {
        std::string name = (std::filesystem::temp_directory_path() / "places-XXXXXX").string();
        path_ = ::mkdtemp(name.data());
    }
    ~Directory() { std::filesystem::remove_all(path_); }
    Directory(const Directory&) = delete;
    Directory& operator=(const Directory&) = delete;
    std::string path() const { return path_.string(); }

  private:
    std::filesystem::path path_;
};

const unsigned cores = std::max(1U, std::thread::hardware_concurrency());

TEST(ImportPlaces, NoMoreRunAtOnceThanThereAreCores)
{
    const Directory running, counts;
    const Rogue rogue("cd " + running.path() + "; touch $$; ls | wc -l >" + counts.path() +
                      "/$$; sleep .1; rm $$; " + answer);
    {
        std::vector<std::jthread> threads;
        for (unsigned i = 0; i < 3 * cores; ++i) {
            threads.emplace_back([&] {
                Progress progress;
                EXPECT_TRUE(import_by(rogue, progress));
            });
        }
    }
    unsigned most = 0, imports = 0;
    for (const auto& file : std::filesystem::directory_iterator(counts.path())) {
        unsigned count = 0;
        std::ifstream(file.path()) >> count;
        most = std::max(most, count);
        ++imports;
    }
    EXPECT_EQ(imports, 3 * cores);
    EXPECT_LE(most, cores);
    if (cores > 1) { EXPECT_GT(most, 1U); }
}

TEST(ImportPlaces, WhoWaitsForOneCanBeStopped)
{
    const Rogue rogue("sleep 60");
    Progress progress;
    std::vector<std::jthread> threads;
    for (unsigned i = 0; i < 2 * cores; ++i) {
        threads.emplace_back([&] {
            const auto image = import_by(rogue, progress);
            ASSERT_FALSE(image);
            EXPECT_EQ(image.error().fault, Fault::Cancelled);
        });
    }
    std::this_thread::sleep_for(100ms);
    const Clock::time_point begin = Clock::now();
    progress.stop();
    threads.clear();
    EXPECT_LT(Clock::now() - begin, 1s);
    EXPECT_TRUE(import_by(answer)) << "every place was given back";
}

}  // namespace
}  // namespace relight::test
