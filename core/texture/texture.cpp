#include "core/texture/texture.h"

namespace relight {

TextureSample sample_linear(const Texture& /*texture*/, const TextureMap& /*map*/, Uv /*uv*/)
{
    return {};
}

TextureSample sample_srgb(const Texture& /*texture*/, const TextureMap& /*map*/, Uv /*uv*/)
{
    return {};
}

}  // namespace relight
