#pragma once

#include <sys/stat.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

namespace relight::test {

/// A file with this content, gone with this object.
class TemporaryFile {
  public:
    explicit TemporaryFile(const std::string& content, ::mode_t mode = 0600)
    {
        std::string name = (std::filesystem::temp_directory_path() / "rogue-XXXXXX").string();
        const int fd = ::mkstemp(name.data());
        ::fchmod(fd, mode);
        ::close(fd);
        path_ = name;
        std::ofstream(path_, std::ios::binary) << content;
    }
    ~TemporaryFile() { std::filesystem::remove(path_); }
    TemporaryFile(const TemporaryFile&) = delete;
    TemporaryFile& operator=(const TemporaryFile&) = delete;
    std::string path() const { return path_.string(); }

  private:
    std::filesystem::path path_;
};

/// A script in place of the importer.
class Rogue : public TemporaryFile {
  public:
    explicit Rogue(const std::string& script)
        : TemporaryFile("#!/bin/sh\nPATH=/usr/bin:/bin\n" + script + '\n', 0700)
    {
    }
};

}  // namespace relight::test
