#include "server/store.h"

#include <gtest/gtest.h>
#include <stdlib.h>

#include <fstream>
#include <limits>

namespace relight {
namespace {

namespace fs = std::filesystem;
constexpr std::uint64_t every_sequence = std::numeric_limits<std::uint64_t>::max();

/// A folder for one test.
class StoreTest : public testing::Test {
  protected:
    StoreTest()
    {
        std::string name = (fs::temp_directory_path() / "relight-store-XXXXXX").string();
        folder = ::mkdtemp(name.data());
    }
    ~StoreTest() override { fs::remove_all(folder); }

    static std::string put(Store& store, std::string_view bytes)
    {
        Store::Incoming incoming = store.begin();
        incoming.add(bytes);
        std::string id = incoming.finish();
        store.keep(std::move(incoming), id, "ply", R"({"id":")" + id + "\"}");
        return id;
    }
    static std::string text_of(const File& file)
    {
        const auto bytes = file.read_all();
        return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
    }
    std::size_t files() const
    {
        return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder), {}));
    }

    fs::path folder;
};

TEST_F(StoreTest, NamesAnObjectByTheSha256OfItsBytes)
{
    Store store(folder);
    // FIPS 180-4, the example "abc"
    EXPECT_EQ(put(store, "abc"),
              "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
}

TEST_F(StoreTest, GivesBackTheVeryBytesAlsoToTheNextServer)
{
    const std::string bytes("a\0b\r\n\xff", 6);
    std::string id;
    {
        Store store(folder);
        id = put(store, bytes);
        EXPECT_EQ(text_of(store.open(id)), bytes);
    }
    const Store again(folder);
    ASSERT_TRUE(again.find(id));
    EXPECT_EQ(again.find(id)->format, "ply");
    EXPECT_EQ(again.find(id)->bytes, bytes.size());
    EXPECT_EQ(again.find(id)->description, R"({"id":")" + id + "\"}");
    EXPECT_EQ(text_of(again.open(id)), bytes);
}

TEST_F(StoreTest, KeepsTheSameBytesOnce)
{
    Store store(folder);
    EXPECT_EQ(put(store, "x"), put(store, "x"));
    EXPECT_EQ(store.list(10, every_sequence).size(), 1U);
    EXPECT_EQ(files(), 3U) << "bytes, description, lock";
}

TEST_F(StoreTest, ListsTheNewestFirstPageByPage)
{
    Store store(folder);
    std::vector<std::string> ids;
    for (const char* bytes : {"1", "2", "3", "4", "5"}) { ids.push_back(put(store, bytes)); }
    std::vector<std::string> listed;
    std::uint64_t before = every_sequence;
    for (auto page = store.list(2, before); !page.empty(); page = store.list(2, before)) {
        for (const auto& object : page) { listed.push_back(object.id); }
        before = page.back().sequence;
    }
    EXPECT_EQ(listed, std::vector<std::string>(ids.rbegin(), ids.rend()));
}

TEST_F(StoreTest, ForgetsWhatIsErased)
{
    Store store(folder);
    const std::string id = put(store, "x");
    EXPECT_TRUE(store.erase(id));
    EXPECT_FALSE(store.erase(id));
    EXPECT_FALSE(store.find(id));
    EXPECT_FALSE(store.open(id));
    EXPECT_EQ(files(), 1U);
}

TEST_F(StoreTest, AFileThatIsNotKeptLeavesNothing)
{
    Store store(folder);
    {
        Store::Incoming incoming = store.begin();
        incoming.add("half a file");
        EXPECT_EQ(files(), 2U);
    }
    EXPECT_EQ(files(), 1U);
}

TEST_F(StoreTest, StandsGarbageInItsFolder)
{
    const std::string other(64, 'a');
    std::string id;
    {
        Store store(folder);
        id = put(store, "x");
    }
    const std::string damaged(64, 'c');
    std::ofstream(folder / "notes.txt") << "mine";
    std::ofstream(folder / (other + ".object")) << "garbage";
    std::ofstream(folder / (damaged + ".object"))
        << "relight-object 1\n5\nply\n99\n{}\n";  // its bytes are too few
    std::ofstream(folder / (damaged + ".bytes")) << "x";
    std::ofstream(folder / "incoming-7.part") << "of a server that crashed";
    std::ofstream(folder / (std::string(64, 'b') + ".bytes")) << "without a description";
    fs::create_directory(folder / (std::string(64, 'd') + ".object"));
    const Store store(folder);
    EXPECT_EQ(store.list(10, every_sequence).size(), 1U);
    EXPECT_TRUE(store.find(id));
    EXPECT_FALSE(store.find(other));
    EXPECT_TRUE(fs::exists(folder / "notes.txt"));
    EXPECT_FALSE(fs::exists(folder / "incoming-7.part"));
    EXPECT_FALSE(fs::exists(folder / (std::string(64, 'b') + ".bytes")));
}

TEST_F(StoreTest, BelongsToOneServerAtATime)
{
    const Store store(folder);
    EXPECT_THROW(Store{folder}, std::runtime_error);
}

TEST(ObjectId, Is64LowerCaseHexDigits)
{
    EXPECT_TRUE(is_object_id(std::string(64, 'a')));
    EXPECT_FALSE(is_object_id(std::string(63, 'a')));
    EXPECT_FALSE(is_object_id(std::string(64, 'A')));
    EXPECT_FALSE(is_object_id("../" + std::string(61, 'a')));
}

}  // namespace
}  // namespace relight
