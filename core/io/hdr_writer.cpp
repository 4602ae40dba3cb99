#include "core/io/writers.h"

namespace relight {

std::string write_hdr(int /*width*/, int /*height*/, std::span<const Rgbf> /*pixels*/,
                      std::span<const std::string> /*comments*/)
{
    return {};
}

}  // namespace relight
