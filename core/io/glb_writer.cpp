#include "core/io/writers.h"

namespace relight {

std::string write_glb(const LitMesh& /*lit*/)
{
    return {};
}

}  // namespace relight
