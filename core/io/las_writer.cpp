#include "core/io/writers.h"

namespace relight {

Result<std::string> write_las(std::span<const std::byte> /*file*/, std::span<const Rgb8> /*color*/)
{
    return std::string();
}

}  // namespace relight
