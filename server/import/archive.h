#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "core/asset.h"

namespace relight {

/// An asset as bytes, handed to `sink` piece by piece; false if that refuses one.
bool write_asset(const Asset& asset, const std::function<bool(std::span<const std::byte>)>& sink);

/// The asset that bytes say; nothing if they are none. They come from a process that a client's
/// file may have taken over: counts are checked against the bytes that are left before anything is
/// allocated, and an asset that breaks a promise of Mesh or Asset (an index out of range, a number
/// that is not finite, arrays of other lengths) is none.
/// @param bytes begin at a multiple of 8
std::optional<Asset> read_asset(std::span<const std::byte> bytes);

}  // namespace relight
