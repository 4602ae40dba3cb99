#include "core/io/writers.h"

namespace relight {

std::string write_obj(const LitMesh& /*lit*/)
{
    return {};
}

}  // namespace relight
