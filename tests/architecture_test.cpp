// The walk of the rooms, held: every #include of core/ and server/ against one table.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <string>
#include <vector>

namespace {

namespace fs = std::filesystem;

struct Room {
    std::set<std::string> rooms;      ///< it may include, beside itself
    std::set<std::string> libraries;  ///< only its .cpp may include: first part of <…>
};

const std::set<std::string> vtk{"vtk", "EGL", "GL", "zlib"};

const std::map<std::string, Room> table{
    {"core/base", {{}, {"immintrin"}}},
    {"core/light", {{"core/base"}, {}}},
    {"core/bsdf", {{"core/base"}, {}}},
    {"core/texture", {{"core/base"}, {}}},
    {"core/geometry", {{"core/base", "core/texture"}, {"OpenMesh", "nanoflann", "hwy"}}},
    {"core",  // core/scene.h, core/asset.h
     {{"core/base", "core/light", "core/bsdf", "core/texture", "core/geometry"}, {}}},
    {"core/trace", {{"core/base", "core/geometry"}, {"embree3"}}},
    {"core/transport",
     {{"core/base", "core/light", "core/bsdf", "core/texture", "core/geometry", "core",
       "core/trace"},
      {"hwy"}}},
    {"core/shade",
     {{"core/base", "core/light", "core/bsdf", "core/texture", "core/geometry", "core",
       "core/trace", "core/transport"},
      {"hwy"}}},
    {"core/display", {{"core/base"}, {"hwy"}}},
    {"core/io",
     {{"core/base", "core/light", "core/geometry", "core/display"},
      {"vtk", "EGL", "GL", "zlib", "OpenEXR", "hwy"}}},
    {"core/preview", {{"core/base", "core/geometry", "core/display"}, vtk}},
    {"core/check",
     {{"core/base", "core/light", "core/bsdf", "core/geometry", "core", "core/trace",
       "core/transport", "core/shade"},
      {}}},
    {"server/import",  // relight-import, a process apart
     {{"core/base", "core/light", "core/bsdf", "core/texture", "core/geometry", "core"},
      {"OpenEXR", "draco", "meshoptimizer", "stb", "nlohmann", "posix"}}},
    {"server",
     {{"server/import", "core/check", "core", "core/base", "core/light", "core/bsdf",
       "core/geometry", "core/trace", "core/transport", "core/shade", "core/display", "core/io",
       "core/preview"},
      {"httplib", "nlohmann", "openssl", "CLI", "zlib", "posix"}}},
};

struct Include {
    std::string file, room, what;
    int line;
    bool quoted, in_header;
};

std::string room_of(const std::string& path)
{
    return fs::path(path).parent_path().string();
}

std::vector<Include> includes()
{
    std::vector<Include> all;
    const std::regex pattern(R"(^\s*#\s*include\s*([<"])([^>"]+)[>"])");
    for (const char* top : {"core", "server"}) {
        for (const auto& entry :
             fs::recursive_directory_iterator(fs::path(RELIGHT_SOURCE_DIR) / top)) {
            const std::string extension = entry.path().extension().string();
            if (extension != ".h" && extension != ".cpp") { continue; }
            const std::string file = fs::relative(entry.path(), RELIGHT_SOURCE_DIR).string();
            std::ifstream text(entry.path());
            std::string line;
            for (int number = 1; std::getline(text, line); ++number) {
                std::smatch match;
                if (!std::regex_search(line, match, pattern)) { continue; }
                all.push_back(
                    {file, room_of(file), match[2], number, match[1] == "\"", extension == ".h"});
            }
        }
    }
    return all;
}

/// "vtk" of vtkPNGWriter.h, "OpenMesh" of OpenMesh/Core/…; empty for the standard library.
std::string library_of(const std::string& header)
{
    if (header.starts_with("vtk")) { return "vtk"; }
    static const std::map<std::string, std::string> flat{{"immintrin.h", "immintrin"},
                                                         {"meshoptimizer.h", "meshoptimizer"},
                                                         {"nanoflann.hpp", "nanoflann"},
                                                         {"httplib.h", "httplib"},
                                                         {"zlib.h", "zlib"}};
    if (const auto found = flat.find(header); found != flat.end()) { return found->second; }
    const auto slash = header.find('/');
    const std::string first = header.substr(0, slash);
    if (slash != std::string::npos) {
        static const std::set<std::string> system{"sys", "netinet", "arpa", "linux"};
        return system.contains(first) ? "posix" : first;
    }
    return header.ends_with(".h") || header.ends_with(".hpp") ? "posix" : "";
}

TEST(Architecture, EveryIncludeFollowsTheWalk)
{
    const std::vector<Include> all = includes();
    EXPECT_GT(all.size(), 100U) << "the reader of includes found too little to be true";
    for (const Include& i : all) {
        const std::string place = i.file + ":" + std::to_string(i.line);
        const auto room = table.find(i.room);
        ASSERT_NE(room, table.end()) << place << ": no such room";
        if (i.quoted) {
            const std::string target = room_of(i.what);
            EXPECT_TRUE(target == i.room || room->second.rooms.contains(target))
                << place << ": " << i.room << " may not include " << i.what;
            continue;
        }
        const std::string library = library_of(i.what);
        if (library.empty()) { continue; }
        EXPECT_TRUE(room->second.libraries.contains(library))
            << place << ": " << i.room << " does not use <" << i.what << ">";
        const bool in_core_header = i.in_header && i.room.starts_with("core");
        EXPECT_FALSE(in_core_header) << place << ": no core header names a third party";
    }
}

TEST(Architecture, ClientsIncludeNothingOfOurs)
{
    const std::regex ours(R"(^\s*#\s*include\s*"(core|server)/)");
    for (const auto& entry :
         fs::recursive_directory_iterator(fs::path(RELIGHT_SOURCE_DIR) / "clients")) {
        if (!entry.is_regular_file()) { continue; }
        std::ifstream text(entry.path());
        std::string line;
        while (std::getline(text, line)) {
            EXPECT_FALSE(std::regex_search(line, ours)) << entry.path() << ": " << line;
        }
    }
}

}  // namespace
