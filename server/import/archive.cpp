#include "server/import/archive.h"

namespace relight {

bool write_asset(const Asset& /*asset*/,
                 const std::function<bool(std::span<const std::byte>)>& /*sink*/)
{
    return false;
}

std::optional<Asset> read_asset(std::span<const std::byte> /*bytes*/)
{
    return {};
}

}  // namespace relight
