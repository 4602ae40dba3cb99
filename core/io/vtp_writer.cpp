#include "core/io/writers.h"

namespace relight {

std::string write_vtp(const LitMesh& /*lit*/)
{
    return {};
}

}  // namespace relight
