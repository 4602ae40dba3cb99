#pragma once

#include <span>
#include <string>

#include "core/io/writers.h"

/// What core/io sends piece by piece, as one string.
namespace relight {

inline std::string write_ply(const LitMesh& lit, PlyEncoding encoding)
{
    return whole(encode_ply(lit, encoding));
}
inline std::string write_npz(const LitMesh& lit)
{
    return whole(encode_npz(lit));
}
inline std::string write_obj(const LitMesh& lit)
{
    return whole(encode_obj(lit));
}
inline std::string write_off(const LitMesh& lit)
{
    return whole(encode_off(lit));
}
inline std::string write_vtp(const LitMesh& lit)
{
    return whole(encode_vtp(lit));
}
inline std::string write_glb(const LitMesh& lit)
{
    return whole(encode_glb(lit));
}
inline Result<std::string> write_las(std::span<const std::byte> file, std::span<const Rgb8> color)
{
    return encode_las(file, color).transform(whole);
}

}  // namespace relight
