#include "core/io/writers.h"

namespace relight {

std::string write_off(const LitMesh& /*lit*/)
{
    return {};
}

}  // namespace relight
