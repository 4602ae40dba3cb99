#include "core/io/readers.h"

namespace relight {

Result<Mesh> read_xyz(std::span<const std::byte> /*file*/, const ReadLimits& /*limits*/,
                      Progress& /*progress*/)
{
    return Error{Fault::NotAvailable, "not read yet", {}, {}, {}};
}

Result<Mesh> read_pts(std::span<const std::byte> /*file*/, const ReadLimits& /*limits*/,
                      Progress& /*progress*/)
{
    return Error{Fault::NotAvailable, "not read yet", {}, {}, {}};
}

}  // namespace relight
