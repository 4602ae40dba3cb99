#pragma once

#include <gtest/gtest.h>

#include <cstring>

#include "tests/io/reader_checks.h"

namespace relight::test {

/// A file that must be refused: how, at which line or byte (-1: none), and a word of the reason.
struct Refusal {
    std::string file;
    Fault fault;
    std::int64_t line, byte;
    std::string_view phrase;
};

inline void expect_refused(Reader reader, const Refusal& row, const ReadLimits& limits = {})
{
    const Result<Mesh> mesh = read(reader, row.file, limits);
    const std::string start = row.file.substr(0, 200);
    ASSERT_FALSE(mesh) << start;
    const Error& error = mesh.error();
    EXPECT_EQ(fault_code(error.fault), fault_code(row.fault)) << start << error.detail;
    EXPECT_EQ(error.line ? static_cast<std::int64_t>(*error.line) : -1, row.line)
        << start << error.detail;
    EXPECT_EQ(error.byte ? static_cast<std::int64_t>(*error.byte) : -1, row.byte)
        << start << error.detail;
    EXPECT_NE(error.detail.find(row.phrase), std::string::npos) << start << error.detail;
}

/// The file of tests/data/clouds of that name.
inline std::string cloud(const std::string& name)
{
    return contents(std::string(RELIGHT_TEST_DATA) + "/clouds/" + name);
}
inline std::string broken(const std::string& name)
{
    return contents(std::string(RELIGHT_TEST_DATA) + "/broken/" + name);
}

template <class T>
void append_bytes(std::string& file, T value)
{
    char bytes[sizeof(T)];
    std::memcpy(bytes, &value, sizeof(T));
    file.append(bytes, sizeof(T));
}
template <class T>
void put_bytes(std::string& file, std::size_t at, T value)
{
    std::memcpy(file.data() + at, &value, sizeof(T));
}

}  // namespace relight::test
