#pragma once

#include <memory>

#include "core/trace/bvh.h"

namespace relight {

/// Everything that depends on the mesh alone, shared by all requests that light it.
struct Stage {
    std::shared_ptr<const Mesh> mesh;
    std::shared_ptr<const Surface> surface;
    std::shared_ptr<const Bvh> bvh;
};

}  // namespace relight
