#include "core/geometry/normal_map.h"

namespace relight {

Dir3 bent_normal(Dir3 smooth, Dir3 /*tangent*/, double /*bitangent_sign*/,
                 const Texture& /*texture*/, const MaterialMaps& /*maps*/, Uv /*uv*/)
{
    return smooth;
}

void apply_normal_maps(const Mesh& /*mesh*/, Surface& /*surface*/) {}

}  // namespace relight
