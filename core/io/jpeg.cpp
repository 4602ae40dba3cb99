#include "core/io/writers.h"

namespace relight {

std::string write_jpeg(int /*width*/, int /*height*/, std::span<const Rgb8> /*pixels*/,
                       int /*quality*/)
{
    return {};
}

}  // namespace relight
